#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace touchtrace::label {

/// Sides of a box that somebody marked in the colour camera's picture around all of a body, what
/// something hides of it, too: planes through that camera's eye, the origin, that touch the body.
struct MarkedSides {
  std::vector<Eigen::Vector3d> outward;  ///< their unit normals, away from the body
  /// Deviation of a plane where the body is, over a point's: by so much less it counts.
  double sigma_in_points = 1.0;
  /// RMS of the box's half width and half height where the body is.
  double radius_m = 0.0;
};

/// What a depth image tells of a body: points on its surface, and rays from the camera to other
/// surfaces, none of which can pass through it. The rays to what lies beside it hold the silhouette
/// where it shows; those that end on fingers before it hold nothing but that it is behind them.
struct BodyView {
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< where all rays begin
  std::vector<Eigen::Vector3f> on_m;                ///< points on the body
  std::vector<Eigen::Vector3f> seen_past_m;         ///< ends of rays that do not enter it
  /// Noise of the points along their rays over `usual_depth_sigma_m`; at least 1.
  double noise_ratio = 1.0;
  /// By what part of their distance pixels may look beside their rays: as deep may one enter a
  /// sphere that it was seen past.
  double looks_beside = 0.0;
  MarkedSides marked = {};  ///< in most views none

  bool is_marked() const { return !marked.outward.empty(); }

  /// How much of a point's distance from a surface counts: noise along the ray moves it the less
  /// from the surface, the more the ray grazes that.
  double counted_part(const Eigen::Vector3d& outward, const Eigen::Vector3d& ray) const {
    if (noise_ratio == 1.0) return 1.0;
    const double along = outward.dot(ray);
    return 1.0 /
           std::sqrt(1.0 + (noise_ratio * noise_ratio - 1.0) * along * along / ray.squaredNorm());
  }
};

/// Noise of depths that is no more than what else is wrong with a point.
inline constexpr double usual_depth_sigma_m = 0.0015;

/// Points of one surface share much of their error: so much each, were they independent. Less of a
/// sphere, which cannot be turned wrong.
inline constexpr double point_sigma_m = 0.003, sphere_point_sigma_m = 0.002;

/// Geman and McClure's loss of a distance: that of strays stays below half the square of `width`.
struct RobustLoss {
  double width_m;

  double cost(double distance_m) const {
    return 0.5 * distance_m * distance_m * inlying(distance_m);
  }
  double weight(double distance_m) const { return inlying(distance_m) * inlying(distance_m); }

 private:
  double inlying(double distance_m) const {
    return width_m * width_m / (width_m * width_m + distance_m * distance_m);
  }
};

/// Huber's loss: what is far off is pulled as well, but no more than what is off by `width`.
struct ConvexLoss {
  double width_m;

  double cost(double distance_m) const {
    const double off = std::abs(distance_m);
    return off < width_m ? 0.5 * off * off : width_m * (off - 0.5 * width_m);
  }
  double weight(double distance_m) const {
    return std::min(1.0, width_m / std::max(width_m, std::abs(distance_m)));
  }
};

/// Of a marked side, in terms of points: one that a wrong pose is far from does little harm.
inline constexpr ConvexLoss side_loss{2.0 * point_sigma_m};

/// Widths of the losses of a fit: first so that it finds its way, then as noise asks for.
inline constexpr double rough_width_m = 0.016, fine_width_m = 0.004;

}  // namespace touchtrace::label
