#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/random.h"
#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

namespace touchtrace::label {

inline constexpr double drawn_noise_m = 0.001;
/// Where drawn bodies are.
inline const Eigen::Vector3d drawn_at(0.02, -0.03, 1.1);

/// Whether something hides what is so far right of and below a body's middle [m].
using Hides = std::function<bool(double, double)>;
inline bool nothing_hides(double, double) { return false; }

/// Where a ray from the origin meets the body: sphere tracing.
inline std::optional<double> hit_m(const RoundedBody& body, const Eigen::Isometry3d& pose,
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

/// How a depth camera at the origin sees a body; what hides it is 1 cm before it.
inline BodyView draw(const RoundedBody& body, const Eigen::Isometry3d& pose, const Hides& hides,
                     std::uint64_t seed = 1, double depth_noise_m = drawn_noise_m) {
  constexpr double pixel_m = 0.0035, half_view_m = 0.09, wall_m = 2.0, over_surface_m = 0.01;
  RandomStream random(seed, "body view");
  BodyView view;
  view.noise_ratio = std::max(1.0, depth_noise_m / usual_depth_sigma_m);
  for (double y = -half_view_m; y <= half_view_m; y += pixel_m)
    for (double x = -half_view_m; x <= half_view_m; x += pixel_m) {
      const Eigen::Vector3d& at = pose.translation();
      const Eigen::Vector3d ray = (at + Eigen::Vector3d(x, y, 0.0)) / at.z();
      const auto hit = hit_m(body, pose, ray);
      const double noise_m = depth_noise_m * random.normal();
      if (hit && hides(x, y))
        view.seen_past_m.push_back(((*hit - over_surface_m + noise_m) * ray).cast<float>());
      else if (hit)
        view.on_m.push_back(((*hit + noise_m) * ray).cast<float>());
      else
        view.seen_past_m.push_back((wall_m * ray).cast<float>());
    }
  return view;
}

inline Eigen::Vector3d centroid(const BodyView& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& point : view.on_m) sum += point.cast<double>();
  return sum / static_cast<double>(view.on_m.size());
}

}  // namespace touchtrace::label
