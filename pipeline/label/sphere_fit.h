#pragma once

#include <Eigen/Core>
#include <vector>

namespace touchtrace::label {

/// What a depth image tells of a sphere: points on its surface, and rays from the camera to other
/// surfaces, none of which can pass through it. The rays to what lies beside it hold the silhouette
/// where it shows; those that end on fingers before it hold nothing but that it is behind them.
struct SphereView {
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< where all rays begin
  std::vector<Eigen::Vector3f> on_m;                ///< points on the sphere
  std::vector<Eigen::Vector3f> seen_past_m;         ///< ends of rays that do not enter it
};

struct SphereFit {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the centre, per m^2 of residual
  double cost_m2 = 0.0;  ///< Cauchy's loss of all distances from the surface
};

/// Centre of a sphere of known radius: Gauss-Newton with Cauchy's loss, wide at first, of the
/// distances between sphere and points and of the depths to which rays enter it. Starts 2/3 radius
/// behind the points' centroid, where a wholly visible sphere has its centre. `on_m` must not be
/// empty.
SphereFit fit_sphere(const SphereView& view, double radius_m);

}  // namespace touchtrace::label
