#include "calib/rgbd/rotation.h"

#include <Eigen/Geometry>
#include <cmath>

namespace touchtrace {
namespace {

constexpr double small_rad = 1e-6;  ///< below it the first order is used; its error is below 1e-12

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return cross;
}

Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  if (angle < small_rad) return Eigen::Matrix3d::Identity() + cross_matrix(r);
  return Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  const Eigen::Matrix3d cross = cross_matrix(r);
  if (angle < small_rad) return Eigen::Matrix3d::Identity() + 0.5 * cross;
  const double half_chord = std::sin(0.5 * angle) / angle;  // 1 - cos loses digits
  return Eigen::Matrix3d::Identity() + 2.0 * half_chord * half_chord * cross +
         (angle - std::sin(angle)) / (angle * angle * angle) * cross * cross;
}

}  // namespace touchtrace
