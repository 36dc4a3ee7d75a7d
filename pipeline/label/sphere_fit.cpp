#include "pipeline/label/sphere_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr int most_fit_steps = 12;
constexpr double still_part = 0.0125;  // of the loss's width
// behind the centroid: of a sphere that is wholly visible, and of one that shows at its rim only
constexpr std::array<double, 2> start_radii{2.0 / 3.0, 0.1};

/// A view as every step of a fit needs it.
struct Rays {
  explicit Rays(const BodyView& view) : seen(view) {
    for (const auto& point : view.on_m) on_m.push_back(point.cast<double>());
    for (const auto& end : view.seen_past_m) {
      const Eigen::Vector3d ray = end.cast<double>() - seen.eye_m;
      past.push_back({ray.normalized(), ray.norm()});
    }
  }

  struct Ray {
    Eigen::Vector3d direction;
    double length_m;
  };
  const BodyView& seen;
  std::vector<Eigen::Vector3d> on_m;
  std::vector<Ray> past;
};

/// Calls use(center - place on the surface or nearest on a ray, its length, distance from where it
/// should be, part of that which counts) of all points and of the rays that enter the sphere.
template <class Use>
void for_each_offset(const Rays& rays, double radius_m, const Eigen::Vector3d& center, Use&& use) {
  for (const auto& point : rays.on_m) {
    const Eigen::Vector3d off = center - point;
    const double length = off.norm();
    const Eigen::Vector3d inward = off / std::max(length, 1e-9);
    use(off, length, length - radius_m, rays.seen.counted_part(inward, point - rays.seen.eye_m));
  }
  const Eigen::Vector3d from_eye = center - rays.seen.eye_m;
  const double passing_m = std::max(0.0, radius_m - rays.seen.looks_beside * from_eye.norm());
  for (const auto& [direction, length_m] : rays.past) {
    const Eigen::Vector3d off =
        from_eye - std::clamp(from_eye.dot(direction), 0.0, length_m) * direction;
    const double square = off.squaredNorm();
    if (square >= passing_m * passing_m) continue;
    const double length = std::sqrt(square);
    use(off, length, length - passing_m, 1.0);
  }
}

struct Sums {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// Gauss-Newton's sums over all points and rays at one centre.
Sums sums_at(const Rays& rays, double radius_m, const Eigen::Vector3d& center,
             const RobustLoss& loss) {
  Sums sums;
  for_each_offset(rays, radius_m, center,
                  [&](const Eigen::Vector3d& off, double length, double residual, double part) {
                    const double inverse = 1.0 / std::max(length, 1e-9);
                    const Eigen::Vector3d weighted =
                        loss.weight(part * residual) * part * part * inverse * off;
                    sums.normal.noalias() += inverse * weighted * off.transpose();
                    sums.gradient += residual * weighted;
                  });
  return sums;
}

double cost_at(const Rays& rays, double radius_m, const Eigen::Vector3d& center,
               const RobustLoss& loss) {
  double cost = 0.0;
  for_each_offset(rays, radius_m, center,
                  [&](const Eigen::Vector3d&, double, double residual, double part) {
                    cost += loss.cost(part * residual);
                  });
  return cost;
}

Eigen::Vector3d centroid(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& point : points) sum += point.cast<double>();
  return sum / static_cast<double>(points.size());
}

/// Gauss-Newton from `start`.
SphereFit descend(const Rays& rays, double radius_m, const Eigen::Vector3d& start) {
  SphereFit fit;
  fit.center_m = start;
  for (const double width_m : {rough_width_m, fine_width_m})
    for (int i = 0; i < most_fit_steps; ++i) {
      const Sums sums = sums_at(rays, radius_m, fit.center_m, {width_m});
      fit.information = sums.normal;
      // one point's worth of the start: never singular
      const Eigen::Vector3d step = (sums.normal + Eigen::Matrix3d::Identity())
                                       .ldlt()
                                       .solve(sums.gradient + fit.center_m - start);
      fit.center_m -= step;
      if (step.norm() < still_part * width_m) break;
    }
  fit.cost_m2 = cost_at(rays, radius_m, fit.center_m, {fine_width_m});
  return fit;
}

}  // namespace

SphereFit fit_sphere(const BodyView& view, double radius_m) {
  const Rays rays(view);
  const Eigen::Vector3d middle = centroid(view.on_m);
  const Eigen::Vector3d ray = (middle - view.eye_m).normalized();
  SphereFit best;
  best.cost_m2 = std::numeric_limits<double>::infinity();
  for (const double part : start_radii) {
    const auto fit = descend(rays, radius_m, middle + part * radius_m * ray);
    if (fit.cost_m2 < best.cost_m2) best = fit;
  }
  return best;
}

}  // namespace touchtrace::label
