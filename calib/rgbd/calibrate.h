#pragma once

#include "calib/board/chessboard.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

inline constexpr int fewest_views = 3;

struct CalibrateSettings {
  std::vector<std::string> lenses = {};  ///< lens_name() of those to choose from; empty: all
  bool cross_validate = false;           ///< fit again without a tenth of the views, ten times
};

/// Intrinsics, distortion, the board's poses, warp and (where they tell it) print, and (where views
/// have depth images) RGB-to-depth pose, depth intrinsics, scale, offset and delay, in one robust
/// least-squares problem with covariance. The delay is estimated where the views are stamped and
/// the board moves.
///
/// The depth camera's intrinsics carry a prior: the factory's within 0.5 %, or, where unknown, the
/// colour camera's within 10 %. `details` says what the data did not tell. Deterministic. Throws
/// data_error if fewer than `fewest_views` different views are usable, one shows the board from
/// behind or has a corner that is no number, or nothing converges.
RgbdCalibration calibrate(const BoardObservations& observations,
                          const CalibrateSettings& settings = {});

}  // namespace touchtrace
