#pragma once

#include <Eigen/Core>

namespace touchtrace {

/// Rotation matrix of the angle-axis vector `r` [rad].
Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& r);

/// Left Jacobian of SO(3), d log(exp(r + e) exp(r)^-1) / d e: maps an increment of the angle-axis
/// vector to a rotation from the left.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r);

/// Skew-symmetric matrix with cross_matrix(v) u = v x u.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

}  // namespace touchtrace
