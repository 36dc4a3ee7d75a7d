#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {
namespace {

using Bodies = Eigen::Matrix<double, fingers_at, fingers_at>;
using BodyVelocity = Eigen::Matrix<double, fingers_at, 1>;

/// In-place L D L' factorization of the lower triangle of a positive definite matrix; the diagonal
/// becomes the inverse of D. Unrolled: Eigen's is written for run-time sizes.
void factorize(Bodies& a) {
#pragma GCC unroll 9
  for (int k = 0; k < fingers_at; ++k) {
    const double inverse = 1.0 / a(k, k);
    a(k, k) = inverse;
#pragma GCC unroll 9
    for (int j = k + 1; j < fingers_at; ++j) {
      const double share = inverse * a(j, k);
#pragma GCC unroll 9
      for (int i = j; i < fingers_at; ++i) a(i, j) -= share * a(i, k);
      a(j, k) = share;
    }
  }
}

void solve_in_place(const Bodies& factor, BodyVelocity& x) {
#pragma GCC unroll 9
  for (int k = 0; k < fingers_at; ++k)
#pragma GCC unroll 9
    for (int i = k + 1; i < fingers_at; ++i) x[i] -= x[k] * factor(i, k);
#pragma GCC unroll 9
  for (int k = fingers_at; k-- > 0;) {
    x[k] *= factor(k, k);
#pragma GCC unroll 9
    for (int i = k + 1; i < fingers_at; ++i) x[k] -= factor(i, k) * x[i];
  }
}

}  // namespace

MotionSystem MotionSystem::zero() {
  MotionSystem system;
  system.bodies.setZero();
  system.coupling.setZero();
  system.fingers.setZero();
  system.momentum.setZero();
  return system;
}

Velocity MotionSystem::solve() const {
  Bodies reduced = bodies;
  BodyVelocity right = momentum.head<fingers_at>();
  for (int i = 0; i < num_fingers; ++i) {
    if (coupling.col(i).isZero(0.0)) continue;
    const BodyVelocity share = coupling.col(i) / fingers[i];
    reduced.noalias() -= coupling.col(i) * share.transpose();
    right -= momentum[fingers_at + i] * share;
  }
  factorize(reduced);
  solve_in_place(reduced, right);
  Velocity velocity;
  velocity.head<fingers_at>() = right;
  velocity.tail<num_fingers>() =
      (momentum.tail<num_fingers>() - coupling.transpose() * velocity.head<fingers_at>())
          .cwiseQuotient(fingers);
  return velocity;
}

}  // namespace touchtrace::scene
