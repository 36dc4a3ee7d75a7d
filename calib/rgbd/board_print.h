#pragma once

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// What the corners tell of the board's print: how far each is off in each direction, about
/// normally distributed, and the noise that is left of the images' corners then.
struct BoardPrint {
  double sigma_m = 0.0, corner_sigma_px = 0.0;
  double bic_gain = 0.0;  ///< over the ideal board
};

/// The print under which the corners are most likely, where camera, poses, warp and offsets may be
/// anything that fits: the restricted likelihood (Patterson and Thompson, Biometrika 1971) of the
/// problem that is linear about `parameters`. It is one unknown that explains all the offsets, so
/// that many of them win nothing by luck.
BoardPrint likeliest_print(const BoardProblem& problem, const RgbdParameters& parameters);

/// Frees the print of a solved problem and solves it again, if BIC is strongly for it: calibration
/// with a board that is not quite what it should be (Strobl and Hirzinger, ICCV workshops 2011).
/// Else all stays as it is. Returns the gain that decided.
double choose_print(BoardProblem& problem, RgbdParameters& parameters);

/// The board that a calibration found: its warp and offsets alone.
RgbdParameters board_of(const RgbdCalibration& calibration);

/// Noise of a corner's coordinate [px] where the problem is solved.
double noise_of_corners_px(const BoardProblem& problem, const RgbdParameters& parameters);

}  // namespace touchtrace
