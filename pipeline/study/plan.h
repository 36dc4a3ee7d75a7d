#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/model/tactile_encoder.h"

namespace touchtrace::study {

/// Data and model to plan for.
struct PlanRequest {
  std::string activity = "wave";
  std::vector<std::string> objects{"ball"};
  bool simulated = true;                ///< data are simulated, not recorded
  bool touch = true;                    ///< false: baseline without touch
  std::string dynamics = "mlp";         ///< or "gru"
  std::string object_encoder = "auto";  ///< "none", "frozen", "joint"; "auto": none or frozen
  int window_frames = 10, rows = 32, cols = 32;
  int tactile_kernel = 3;
  std::array<int, 3> tactile_strides{2, 2, 2};
  LiveTaxels live = {};  ///< empty: unknown
};

/// Part of a stage, and the reason why it is included or omitted.
struct PlanItem {
  std::string stage, part;
  bool included;
  std::string why;
};

/// Parts of simulation, labelling, training and evaluation that a request needs. Omitted parts are
/// not compiled, allocated or run.
struct Plan {
  ModelSpec model;
  std::vector<PlanItem> items;
};

/// Derives model and parts from the request. Without simulation, touch or several objects it omits
/// what only these need.
Plan make_plan(const PlanRequest& request);

/// {"activity","objects","model","items":[{"stage","part","included","why"}...]}
nlohmann::json plan_json(const PlanRequest& request, const Plan& plan);

}  // namespace touchtrace::study
