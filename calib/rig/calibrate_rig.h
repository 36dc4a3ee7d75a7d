#pragma once

#include "calib/rgbd/calibrate.h"
#include "calib/rig/rig.h"

namespace touchtrace {

/// A camera of a rig and its views of the board, without depth.
struct RigInput {
  std::string name;
  BoardObservations observations;
};

/// Calibrates each camera alone, pairs the views (pair_frames), and estimates all intrinsics, the
/// cameras' relative poses, board poses, warp and, if a camera alone supports it, per-corner
/// deformation in one robust least-squares problem. Frames whose residuals exceed three times those
/// of the median frame are excluded: wrong pairs, or a board that moved between two shots. The
/// covariance counts frames, as that of calibrate() counts views. Deterministic.
///
/// Throws data_error as calibrate(), and if two cameras share fewer than three usable frames.
RigCalibration calibrate_rig(std::vector<RigInput> inputs, const CalibrationOptions& options = {});

}  // namespace touchtrace
