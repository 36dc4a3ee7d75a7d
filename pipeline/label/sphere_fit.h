#pragma once

#include "pipeline/label/body_view.h"

namespace touchtrace::label {

struct SphereFit {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the centre, per m^2 of residual
  double cost_m2 = 0.0;  ///< loss of all distances from the surface
};

/// Centre of a sphere of known radius: Gauss-Newton with a robust loss, wide at first, of the
/// distances between sphere and points and of the depths to which rays enter it. Starts 2/3 radius
/// behind the points' centroid, where a wholly visible sphere has its centre. `on_m` must not be
/// empty.
SphereFit fit_sphere(const BodyView& view, double radius_m);

}  // namespace touchtrace::label
