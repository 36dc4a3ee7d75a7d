#pragma once

#include <nlohmann/json.hpp>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// What a camera fitted without some views does on them: their poses are fitted to it, the camera
/// is not.
struct HeldOut {
  double training_rms_px = 0.0, held_out_rms_px = 0.0;  ///< of the same views
  int folds = 0;

  double ratio() const { return held_out_rms_px / training_rms_px; }
};

/// Ten folds of the used views (as many as views if those are fewer), every tenth in one, with the
/// lens and the outlier views of `solution`. Colour only. Not finite if a fold does not converge.
HeldOut cross_validate(const BoardProblem& problem, const RgbdParameters& solution);

nlohmann::json held_out_json(const HeldOut& held_out);

}  // namespace touchtrace
