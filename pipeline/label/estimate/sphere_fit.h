#pragma once

#include "pipeline/label/estimate/body_view.h"

namespace touchtrace::label {

struct SphereFit {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< for residuals of variance 1 m^2
  double cost_m2 = 0.0;                                   ///< at the minimum
};

/// Fits the centre of a sphere of known radius (cost: BodyView, without box planes) by Gauss-Newton
/// with the coarse loss, then the fine one. Two starts behind the centroid of the surface points:
/// 2/3 radius, right for a wholly visible sphere, and 0.1 radius, right for one whose rim shows.
/// Requires at least one surface point.
SphereFit fit_sphere(const BodyView& view, double radius_m);

}  // namespace touchtrace::label
