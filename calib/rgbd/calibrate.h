#pragma once

#include "calib/board/chessboard.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

inline constexpr int fewest_views = 3;

struct CalibrateSettings {
  int radial_coefficients = -1;  ///< 0, 2 or 3; -1: chosen by BIC
};

/// Intrinsics, distortion, board poses, and (where views have depth images) RGB-to-depth pose,
/// depth intrinsics, scale and offset, in one robust least-squares problem with covariance.
///
/// The depth camera's intrinsics carry a prior: the factory's within 0.5 %, or, where unknown, the
/// colour camera's within 10 %. `details` says what the data did not tell. Deterministic. Throws
/// data_error if fewer than `fewest_views` views are usable or nothing converges.
RgbdCalibration calibrate(const BoardObservations& observations,
                          const CalibrateSettings& settings = {});

}  // namespace touchtrace
