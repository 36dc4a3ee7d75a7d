#pragma once

#include <Eigen/Core>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Offsets of the velocities that are solved for together, in the object's body frame: hand,
/// object, the object's angular velocity, fingers.
inline constexpr int hand_at = 0, object_at = 3, spin_at = 6, fingers_at = 9;
inline constexpr int num_velocities = fingers_at + num_fingers;
using Velocity = Eigen::Matrix<double, num_velocities, 1>;
using FingerRates = Eigen::Matrix<double, num_fingers, 1>;

/// Symmetric positive definite linear system in all velocities. Fingers are not coupled with each
/// other, so it is an arrow matrix: [bodies, coupling; coupling', diag(fingers)].
struct MotionSystem {
  Eigen::Matrix<double, fingers_at, fingers_at> bodies;  ///< lower triangle
  Eigen::Matrix<double, fingers_at, num_fingers> coupling;
  FingerRates fingers;
  Velocity momentum;  ///< right-hand side

  static MotionSystem zero();
  Velocity solve() const;
};

}  // namespace touchtrace::scene
