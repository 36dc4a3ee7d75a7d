#include "pipeline/scene/motion_system.h"

#include <Eigen/Cholesky>

namespace touchtrace::scene {

MotionSystem MotionSystem::zero() {
  MotionSystem system;
  system.bodies.setZero();
  system.columns.setZero();
  system.fingers.setZero();
  system.momentum.setZero();
  return system;
}

Velocity MotionSystem::solve() const {
  auto reduced = bodies;
  Eigen::Matrix<double, fingers_at, 1> right = momentum.head<fingers_at>();
  for (int i = 0; i < finger_count; ++i) {
    if (columns.col(i).isZero(0.0)) continue;
    const Eigen::Matrix<double, fingers_at, 1> share = columns.col(i) / fingers[i];
    for (int j = 0; j < fingers_at; ++j)
      reduced.col(j).tail(fingers_at - j) -= share[j] * columns.col(i).tail(fingers_at - j);
    right -= momentum[fingers_at + i] * share;
  }
  Velocity velocity;
  velocity.head<fingers_at>() = reduced.llt().solve(right);
  velocity.tail<finger_count>() =
      (momentum.tail<finger_count>() - columns.transpose() * velocity.head<fingers_at>())
          .cwiseQuotient(fingers);
  return velocity;
}

}  // namespace touchtrace::scene
