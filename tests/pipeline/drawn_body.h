#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/random.h"
#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

namespace touchtrace::label {

inline constexpr double drawn_noise_m = 0.001;
/// Distance of rays at the body's centre.
inline constexpr double drawn_pixel_m = 0.0035;
/// Centre of drawn bodies.
inline const Eigen::Vector3d drawn_at(0.02, -0.03, 1.1);

/// Whether an occluder covers a point that is (right, below) of the body's centre [m].
using IsHidden = std::function<bool(double, double)>;
inline bool nothing_hidden(double, double) { return false; }

/// Distance along a ray from the origin to the body, in lengths of `ray`: sphere tracing.
inline std::optional<double> trace_ray(const RoundedBody& body, const Eigen::Isometry3d& pose,
                                       const Eigen::Vector3d& ray) {
  constexpr double before = 0.8, behind = 1.5, touching_m = 1e-6;
  double along = before;
  for (int i = 0; i < 200 && along < behind; ++i) {
    const double distance = surface_distance(body, pose.inverse() * (along * ray)).distance_m;
    if (distance < touching_m) return along;
    along += distance / ray.norm();
  }
  return std::nullopt;
}

/// View of a body by a depth camera at the origin; the occluder is 1 cm in front of the surface.
inline BodyView draw(const RoundedBody& body, const Eigen::Isometry3d& pose,
                     const IsHidden& is_hidden, std::uint64_t seed = 1,
                     double depth_noise_m = drawn_noise_m) {
  constexpr double half_view_m = 0.09, wall_m = 2.0, over_surface_m = 0.01;
  RandomStream random(seed, "body view");
  BodyView view;
  view.noise_ratio = std::max(1.0, depth_noise_m / reference_depth_sigma_m);
  for (double y = -half_view_m; y <= half_view_m; y += drawn_pixel_m)
    for (double x = -half_view_m; x <= half_view_m; x += drawn_pixel_m) {
      const Eigen::Vector3d& at = pose.translation();
      const Eigen::Vector3d ray = (at + Eigen::Vector3d(x, y, 0.0)) / at.z();
      const auto hit = trace_ray(body, pose, ray);
      const double noise_m = depth_noise_m * random.normal();
      if (hit && is_hidden(x, y))
        view.free_space_endpoints.push_back(
            ((*hit - over_surface_m + noise_m) * ray).cast<float>());
      else if (hit)
        view.surface_points.push_back(((*hit + noise_m) * ray).cast<float>());
      else
        view.free_space_endpoints.push_back((wall_m * ray).cast<float>());
    }
  return view;
}

}  // namespace touchtrace::label
