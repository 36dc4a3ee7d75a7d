#pragma once

#include "calib/camera/camera.h"

namespace touchtrace {

/// A projected point and its derivatives. All are NaN where the lens cannot project.
struct ProjectionJacobian {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;  ///< [px/m]
  /// By fx fy cx cy and the coefficients; 0 for those that the lens does not have.
  Eigen::Matrix<double, 2, max_intrinsics> by_intrinsics;
};

/// Differentiates project_point() at a point of the camera frame [m].
ProjectionJacobian projection_jacobian(const Lens& lens, const double* intrinsics,
                                       const Eigen::Vector3d& point_m);
ProjectionJacobian projection_jacobian(const Camera& camera, const Eigen::Vector3d& point_m);

}  // namespace touchtrace
