#include "pipeline/label/sphere_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr std::array<double, 2> cauchy_steps_m{0.016, 0.004};  // wide, then as noise asks for
constexpr int most_fit_steps = 12;
constexpr double still_m = 5e-5;
// behind the centroid: of a sphere that is wholly visible, and of one that shows at its rim only
constexpr std::array<double, 2> start_radii{2.0 / 3.0, 0.1};

/// Gauss-Newton's sums over all points and rays at one centre.
class Sums {
 public:
  Sums(const SphereView& view, double radius_m, const Eigen::Vector3d& center, double cauchy)
      : center_(center), radius_m_(radius_m), square_(cauchy * cauchy) {
    for (const auto& point : view.on_m) {
      const Eigen::Vector3d off = center - point.cast<double>();
      add(off, off.norm() - radius_m);
    }
    for (const auto& end : view.seen_past_m) {
      const Eigen::Vector3d off = center - nearest_on_ray(view.eye_m, end.cast<double>());
      if (const double distance = off.norm(); distance < radius_m) add(off, distance - radius_m);
    }
  }

  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0.0;

 private:
  Eigen::Vector3d nearest_on_ray(const Eigen::Vector3d& eye, const Eigen::Vector3d& end) const {
    const Eigen::Vector3d ray = end - eye;
    return eye + std::clamp((center_ - eye).dot(ray) / ray.squaredNorm(), 0.0, 1.0) * ray;
  }

  void add(const Eigen::Vector3d& off, double residual) {
    const Eigen::Vector3d direction = off / std::max(off.norm(), 1e-9);
    const double weight = 1.0 / (1.0 + residual * residual / square_);
    normal += weight * direction * direction.transpose();
    gradient += weight * residual * direction;
    cost += 0.5 * square_ * std::log1p(residual * residual / square_);
  }

  Eigen::Vector3d center_;
  double radius_m_, square_;
};

Eigen::Vector3d centroid(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& point : points) sum += point.cast<double>();
  return sum / static_cast<double>(points.size());
}

/// Gauss-Newton from `start`.
SphereFit descend(const SphereView& view, double radius_m, const Eigen::Vector3d& start) {
  SphereFit fit;
  fit.center_m = start;
  for (const double cauchy : cauchy_steps_m)
    for (int i = 0; i < most_fit_steps; ++i) {
      const Sums sums(view, radius_m, fit.center_m, cauchy);
      fit.cost_m2 = sums.cost;
      fit.information = sums.normal;
      // one point's worth of the start: never singular
      const Eigen::Vector3d step = (sums.normal + Eigen::Matrix3d::Identity())
                                       .ldlt()
                                       .solve(sums.gradient + fit.center_m - start);
      fit.center_m -= step;
      if (step.norm() < still_m) break;
    }
  return fit;
}

}  // namespace

SphereFit fit_sphere(const SphereView& view, double radius_m) {
  const Eigen::Vector3d middle = centroid(view.on_m);
  const Eigen::Vector3d ray = (middle - view.eye_m).normalized();
  SphereFit best;
  best.cost_m2 = std::numeric_limits<double>::infinity();
  for (const double part : start_radii) {
    const auto fit = descend(view, radius_m, middle + part * radius_m * ray);
    if (fit.cost_m2 < best.cost_m2) best = fit;
  }
  return best;
}

}  // namespace touchtrace::label
