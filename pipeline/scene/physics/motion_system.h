#pragma once

#include <Eigen/Core>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Order of the velocities that are solved for together: hand, object, the object's spin, fingers.
inline constexpr int hand_at = 0, object_at = 3, spin_at = 6, fingers_at = 9;
inline constexpr int velocity_count = fingers_at + finger_count;
using Velocity = Eigen::Matrix<double, velocity_count, 1>;
using FingerRates = Eigen::Matrix<double, finger_count, 1>;

/// A symmetric positive definite system in all velocities. Fingers touch the bodies, never each
/// other, so it is an arrow: [bodies, columns; columns', diag(fingers)].
struct MotionSystem {
  Eigen::Matrix<double, fingers_at, fingers_at> bodies;  ///< lower triangle
  Eigen::Matrix<double, fingers_at, finger_count> columns;
  FingerRates fingers;
  Velocity momentum;  ///< the right side

  static MotionSystem zero();
  Velocity solve() const;
};

}  // namespace touchtrace::scene
