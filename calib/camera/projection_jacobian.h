#pragma once

#include "calib/camera/camera.h"

namespace touchtrace {

/// Jacobian [px/m] of Camera::project() at a point of the camera frame [m]. NaN where the lens
/// cannot project.
Eigen::Matrix<double, 2, 3> projection_jacobian(const Camera& camera,
                                                const Eigen::Vector3d& point_m);

}  // namespace touchtrace
