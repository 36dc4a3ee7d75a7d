#pragma once

#include "calib/rig/rig.h"

namespace touchtrace {

/// Difference of a camera's pose in two calibrations of one rig.
struct PoseDifference {
  double position_m, rotation_rad;
  double rms_sigmas;  ///< sqrt(e' C^-1 e / 6): about 1 if both covariances are right

  /// Whether the stated covariances explain the difference.
  bool agrees() const { return rms_sigmas <= 2.0; }
};

/// For each camera but the first. A rig of another program has no covariance and counts as exact.
/// Throws data_error if the numbers of cameras differ or no rig has a covariance.
std::vector<PoseDifference> compare(const RigCalibration& a, const RigCalibration& b);

}  // namespace touchtrace
