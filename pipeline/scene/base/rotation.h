#pragma once

#include <Eigen/Geometry>

namespace touchtrace::scene {

/// About the vector's direction, by its length in radians.
inline Eigen::Quaterniond rotation_by(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

}  // namespace touchtrace::scene
