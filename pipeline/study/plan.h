#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/model/tactile_encoder.h"
#include "pipeline/study/tracker_choice.h"

namespace touchtrace::study {

/// What a scene holds and what is wanted from it.
struct PlanWishes {
  std::string activity = "wave";
  std::vector<std::string> objects{"ball"};
  bool simulated = true;  ///< the data come from the simulator, not from a glove and a camera
  bool touch = true;      ///< false: only the baseline without touch
  std::string dynamics = "mlp";         ///< or "gru"
  std::string object_encoder = "auto";  ///< "none", "frozen", "joint"; "auto": frozen if any
  int window_frames = 10, rows = 32, cols = 32;
  int tactile_kernel = 3;
  std::array<int, 3> tactile_strides{2, 2, 2};
  LiveTaxels live = {};  ///< empty: not known yet
  TrackerChoice tracker = usual_tracker();
};

struct PlanItem {
  std::string stage, part;
  bool included;
  std::string why;
};

/// What will be built and run, and what is left out: what is left out costs nothing.
struct Plan {
  ModelSpec model;
  std::vector<PlanItem> items;
};

Plan make_plan(const PlanWishes& wishes);

/// {"activity","objects","model","items":[{"stage","part","included","why"}...]}
nlohmann::json plan_json(const PlanWishes& wishes, const Plan& plan);

}  // namespace touchtrace::study
