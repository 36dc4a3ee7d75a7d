#pragma once

#include <Eigen/Core>

namespace touchtrace {

/// exp of the angle-axis `r` [rad].
Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& r);

/// d log(exp(r + e) exp(r)^-1) / d e: turns an increment of the angle-axis into a rotation from the
/// left.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r);

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);  ///< times u: v x u

}  // namespace touchtrace
