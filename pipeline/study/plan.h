#pragma once

#include <string>
#include <vector>

#include "engine/model/tactile_encoder.h"

namespace touchtrace::study {

/// Data and model to plan for.
struct PlanRequest {
  std::vector<std::string> objects{"ball"};
  bool is_simulated = true;  ///< data are simulated, not recorded
  ModelSpec spec = {};
  LiveTaxels live = {};  ///< empty: unknown
};

/// Part of a stage, and the reason why it is included or skipped.
struct PlanItem {
  std::string stage, part;
  bool included;
  std::string why;
};

/// Parts of simulation, training and evaluation that depend on the request. Skipped parts are not
/// compiled, allocated or run.
std::vector<PlanItem> plan_items(const PlanRequest& request);

}  // namespace touchtrace::study
