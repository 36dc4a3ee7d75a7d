#include "pipeline/scene/physics/contact_sums.h"

#include "pipeline/scene/base/rotation.h"

namespace touchtrace::scene {

using Eigen::Matrix3d;

Matrix6d ContactSums::resistance() const {
  const Eigen::Matrix4d isotropic = isotropic_sum_.matrix();
  const Matrix3d second = isotropic.topLeftCorner<3, 3>(), one = Matrix3d::Identity();
  const Matrix3d moment = cross_matrix(isotropic.topRightCorner<3, 1>());
  Matrix6d m = normal_sum_.matrix();
  m.topLeftCorner<3, 3>() += isotropic(3, 3) * one;
  m.bottomLeftCorner<3, 3>() += moment;
  m.topRightCorner<3, 3>() -= moment;
  m.bottomRightCorner<3, 3>() += second.trace() * one - second;
  return m;
}

Vector6d ContactSums::bias() const { return stack({sum(force_), sum(torque_)}); }

void add_to_bodies(MotionSystem& system, const Matrix6d& resistance, const Vector6d& bias) {
  const auto linear = resistance.topLeftCorner<3, 3>(),
             moment = resistance.bottomLeftCorner<3, 3>();
  system.bodies.block<3, 3>(hand_at, hand_at) += linear;
  system.bodies.block<3, 3>(object_at, hand_at) -= linear;
  system.bodies.block<3, 3>(object_at, object_at) += linear;
  system.bodies.block<3, 3>(spin_at, hand_at) -= moment;
  system.bodies.block<3, 3>(spin_at, object_at) += moment;
  system.bodies.block<3, 3>(spin_at, spin_at) += resistance.bottomRightCorner<3, 3>();
  system.momentum.segment<3>(hand_at) += bias.head<3>();
  system.momentum.segment<3>(object_at) -= bias.head<3>();
  system.momentum.segment<3>(spin_at) -= bias.tail<3>();
}

void add_to_finger(MotionSystem& system, int finger, const Twist& flexion_twist,
                   const Matrix6d& resistance, const Vector6d& bias) {
  const Vector6d twist = stack(flexion_twist), column = resistance * twist;
  auto coupling = system.coupling.col(finger);
  coupling.segment<3>(hand_at) += column.head<3>();
  coupling.segment<3>(object_at) -= column.head<3>();
  coupling.segment<3>(spin_at) -= column.tail<3>();
  system.fingers[finger] += twist.dot(column);
  system.momentum[fingers_at + finger] += twist.dot(bias);
}

}  // namespace touchtrace::scene
