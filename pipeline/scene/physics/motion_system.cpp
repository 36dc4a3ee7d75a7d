#include "pipeline/scene/physics/motion_system.h"

#include <cmath>

namespace touchtrace::scene {
namespace {

using Bodies = Eigen::Matrix<double, fingers_at, fingers_at>;
using BodyVelocity = Eigen::Matrix<double, fingers_at, 1>;

/// Cholesky's factor in place of the lower triangle of a positive definite matrix. Eigen's is made
/// for sizes that are not known while it is compiled.
void factorize(Bodies& a) {
  for (int k = 0; k < fingers_at; ++k) {
    const double diagonal = std::sqrt(a(k, k)), inverse = 1.0 / diagonal;
    a(k, k) = diagonal;
    for (int i = k + 1; i < fingers_at; ++i) a(i, k) *= inverse;
    for (int j = k + 1; j < fingers_at; ++j)
      for (int i = j; i < fingers_at; ++i) a(i, j) -= a(j, k) * a(i, k);
  }
}

void solve_in_place(const Bodies& factor, BodyVelocity& x) {
  for (int k = 0; k < fingers_at; ++k) {
    x[k] /= factor(k, k);
    for (int i = k + 1; i < fingers_at; ++i) x[i] -= x[k] * factor(i, k);
  }
  for (int k = fingers_at; k-- > 0;) {
    for (int i = k + 1; i < fingers_at; ++i) x[k] -= factor(i, k) * x[i];
    x[k] /= factor(k, k);
  }
}

}  // namespace

MotionSystem MotionSystem::zero() {
  MotionSystem system;
  system.bodies.setZero();
  system.columns.setZero();
  system.fingers.setZero();
  system.momentum.setZero();
  return system;
}

Velocity MotionSystem::solve() const {
  Bodies reduced = bodies;
  BodyVelocity right = momentum.head<fingers_at>();
  for (int i = 0; i < finger_count; ++i) {
    if (columns.col(i).isZero(0.0)) continue;
    const BodyVelocity share = columns.col(i) / fingers[i];
    for (int j = 0; j < fingers_at; ++j)
      reduced.col(j).tail(fingers_at - j) -= share[j] * columns.col(i).tail(fingers_at - j);
    right -= momentum[fingers_at + i] * share;
  }
  factorize(reduced);
  solve_in_place(reduced, right);
  Velocity velocity;
  velocity.head<fingers_at>() = right;
  velocity.tail<finger_count>() =
      (momentum.tail<finger_count>() - columns.transpose() * velocity.head<fingers_at>())
          .cwiseQuotient(fingers);
  return velocity;
}

}  // namespace touchtrace::scene
