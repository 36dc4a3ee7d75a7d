#pragma once

#include <nlohmann/json.hpp>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Result of cross-validation over views. The poses of held-out views are fitted to the camera of
/// the other views.
struct HeldOut {
  double training_rms_px = 0.0, held_out_rms_px = 0.0;  ///< over the same views
  int folds = 0;

  double ratio() const { return held_out_rms_px / training_rms_px; }
};

/// Cross-validates the colour camera with min(10, used views) folds; fold i holds every tenth used
/// view from i on. Lens and outlier views are those of `solution`. NaN if a fold does not converge.
HeldOut cross_validate(const BoardProblem& problem, const RgbdParameters& solution);

nlohmann::json held_out_json(const HeldOut& held_out);

}  // namespace touchtrace
