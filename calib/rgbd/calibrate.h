#pragma once

#include "calib/board/chessboard.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

inline constexpr int min_views = 3;

struct CalibrationOptions {
  std::vector<std::string> lenses = {};  ///< lens_name() of the candidates; empty: all
  bool target_deformation = true;        ///< estimate offsets of its corners, if BIC favours it
  bool cross_validate = false;           ///< adds the held-out error of ten folds to `details`
};

/// Estimates intrinsics, distortion, board poses, warp and, where the views support it, per-corner
/// deformation; with depth images also depth_from_color, depth intrinsics, scale, offset and delay.
/// One robust least-squares problem with covariance. The delay is estimated only if the views have
/// time stamps and the board moves.
///
/// The depth intrinsics have a prior: the factory's with a standard deviation of 0.5 %, or, if
/// unknown, the colour camera's with 10 %. details["not_identifiable"] lists parameters that the
/// priors determine. Deterministic.
///
/// Throws data_error if fewer than `min_views` different views are usable, a view shows the board
/// from behind or has a corner that is not finite, or the solver does not converge.
RgbdCalibration calibrate(BoardObservations observations, const CalibrationOptions& options = {});

}  // namespace touchtrace
