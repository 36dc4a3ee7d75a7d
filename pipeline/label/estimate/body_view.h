#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace touchtrace::label {

/// Sides of a bounding box that a user drew around a whole body, hidden parts included: planes
/// through the colour camera's centre (the origin) that touch the body.
struct BoxPlanes {
  std::vector<Eigen::Vector3d> outward;  ///< unit normals pointing away from the body
  /// Standard deviation of a plane's distance at the body, over `point_sigma_m`. Residuals of
  /// planes are divided by it.
  double sigma_ratio = 1.0;
  double radius_m = 0.0;  ///< RMS of the box's half width and half height at the body's distance
};

/// Measurements of one body in one depth image [m, colour camera's frame]. A point constrains the
/// surface; a ray from `origin_m` to a free-space endpoint must not enter the body. Rays that end
/// behind the body constrain its silhouette; rays that end on fingers in front of it only tell that
/// the body is behind them.
///
/// All fits minimise the same cost over their unknowns:
///
///     sum over points  GemanMcClureLoss(residual_weight * distance to the surface)
///   + sum over rays    GemanMcClureLoss(depth by which the ray enters the body)
///   + sum over planes  HuberLoss(distance of the body's extreme point to the plane / sigma_ratio)
///
/// They differ in unknowns and priors:
///  - sphere_fit: centre of a sphere, one view. Distances and ray depths have closed forms. Rays
///    may enter by the size of a pixel.
///  - pose_optimizer: pose of a body of known shape, one view. Runs for every frame and hypothesis,
///    with a prior on the pose.
///  - shape_problem: shape and one pose per view, jointly. Runs a few times per recording. Uses
///    Ceres, which handles the bounds on the shape and the elimination of the poses.
/// A sphere given to pose_optimizer has the same minimum, but other steps, another stopping rule
/// and bisected instead of exact ray depths (0.1 mm): centres would change in their last digits.
struct BodyView {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< start of all rays
  std::vector<Eigen::Vector3f> surface_points;         ///< on the body's surface
  std::vector<Eigen::Vector3f> free_space_endpoints;   ///< ends of rays that do not enter it
  double noise_ratio = 1.0;         ///< depth noise over `reference_depth_sigma_m`; at least 1
  double pixel_angular_size = 0.0;  ///< [rad]; fit_sphere lets rays enter by this times distance
  BoxPlanes box = {};               ///< empty in most views

  bool has_box_planes() const { return !box.outward.empty(); }

  /// Mean of the surface points; there must be at least one.
  Eigen::Vector3d centroid_m() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& point : surface_points) sum += point.cast<double>();
    return sum / static_cast<double>(surface_points.size());
  }

  /// Factor of a point's distance from the surface, in (0, 1]. Depth noise acts along the ray, so a
  /// grazing ray (perpendicular to the normal `outward`) keeps weight 1.
  double residual_weight(const Eigen::Vector3d& outward, const Eigen::Vector3d& ray) const {
    if (noise_ratio == 1.0) return 1.0;
    const double along = outward.dot(ray);
    return 1.0 /
           std::sqrt(1.0 + (noise_ratio * noise_ratio - 1.0) * along * along / ray.squaredNorm());
  }
};

/// Depth noise up to which other errors of a point dominate.
inline constexpr double reference_depth_sigma_m = 0.0015;

/// Noise ratio where depth noise is unknown, and the least in shape learning: errors that
/// neighbouring pixels share do not show in their scatter. A bar of a real camera, 34 mm across,
/// became a plank of 30 by 55 mm at 1 and 2 and had its true size at 4 and 8; a block was right at
/// 1 to 4.
inline constexpr double shared_noise_ratio = 4.0;

/// Standard deviation of a surface point, were errors independent. Larger than the sensor's noise
/// because points of one surface share much of their error; smaller for a sphere, which has no
/// rotation to be wrong about.
inline constexpr double point_sigma_m = 0.003, sphere_point_sigma_m = 0.002;

/// Half the loss of Geman and McClure (1987): cost(r) = r^2 / 2 * w^2 / (w^2 + r^2) < w^2 / 2.
struct GemanMcClureLoss {
  double width_m;

  double cost(double residual_m) const {
    return 0.5 * residual_m * residual_m * inlier_factor(residual_m * residual_m);
  }
  /// d cost / d r over r.
  double weight(double residual_m) const {
    return inlier_factor(residual_m * residual_m) * inlier_factor(residual_m * residual_m);
  }
  double inlier_factor(double square_m2) const {
    return width_m * width_m / (width_m * width_m + square_m2);
  }
};

/// Huber's loss: quadratic up to `width_m`, then linear.
struct HuberLoss {
  double width_m;

  double cost(double residual_m) const {
    const double size = std::abs(residual_m);
    return size < width_m ? 0.5 * size * size : width_m * (size - 0.5 * width_m);
  }
  double weight(double residual_m) const {
    return std::min(1.0, width_m / std::max(width_m, std::abs(residual_m)));
  }
};

/// Loss of a box plane's residual. Linear, so that a pose far from the box is still pulled to it.
inline constexpr HuberLoss plane_loss{2.0 * point_sigma_m};

/// Loss widths: coarse for convergence from a rough start, fine according to the noise.
inline constexpr double coarse_loss_width_m = 0.016, fine_loss_width_m = 0.004;

}  // namespace touchtrace::label
