#include "pipeline/scene/physics/contact_sums.h"

namespace touchtrace::scene {

using Eigen::Matrix3d;

Matrix6d ContactSums::resistance() const {
  const Eigen::Matrix4d about = about_.matrix();
  const Matrix3d second = about.topLeftCorner<3, 3>(), one = Matrix3d::Identity();
  const Eigen::Vector3d first = about.topRightCorner<3, 1>();
  Matrix3d moment;
  moment << 0.0, -first.z(), first.y(), first.z(), 0.0, -first.x(), -first.y(), first.x(), 0.0;
  Matrix6d m = along_.matrix();
  m.topLeftCorner<3, 3>() += about(3, 3) * one;
  m.bottomLeftCorner<3, 3>() += moment;
  m.topRightCorner<3, 3>() -= moment;
  m.bottomRightCorner<3, 3>() += second.trace() * one - second;
  return m;
}

Vector6d ContactSums::push() const { return joined({sum(force_), sum(torque_)}); }

void add_to_bodies(MotionSystem& system, const Matrix6d& resistance, const Vector6d& push) {
  const auto shift = resistance.topLeftCorner<3, 3>(), turned = resistance.bottomLeftCorner<3, 3>();
  system.bodies.block<3, 3>(hand_at, hand_at) += shift;
  system.bodies.block<3, 3>(object_at, hand_at) -= shift;
  system.bodies.block<3, 3>(object_at, object_at) += shift;
  system.bodies.block<3, 3>(spin_at, hand_at) -= turned;
  system.bodies.block<3, 3>(spin_at, object_at) += turned;
  system.bodies.block<3, 3>(spin_at, spin_at) += resistance.bottomRightCorner<3, 3>();
  system.momentum.segment<3>(hand_at) += push.head<3>();
  system.momentum.segment<3>(object_at) -= push.head<3>();
  system.momentum.segment<3>(spin_at) -= push.tail<3>();
}

void add_to_finger(MotionSystem& system, int finger, const Twist& with_flexion,
                   const Matrix6d& resistance, const Vector6d& push) {
  const Vector6d way = joined(with_flexion), column = resistance * way;
  auto bodies = system.columns.col(finger);
  bodies.segment<3>(hand_at) += column.head<3>();
  bodies.segment<3>(object_at) -= column.head<3>();
  bodies.segment<3>(spin_at) -= column.tail<3>();
  system.fingers[finger] += way.dot(column);
  system.momentum[fingers_at + finger] += way.dot(push);
}

}  // namespace touchtrace::scene
