#pragma once

#include <Eigen/Geometry>
#include <numbers>

namespace touchtrace::scene {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// Cross-product matrix [v]x.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Rotation about the vector's direction by its length in radians.
inline Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
}

}  // namespace touchtrace::scene
