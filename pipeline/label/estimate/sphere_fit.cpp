#include "pipeline/label/estimate/sphere_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

constexpr int max_fit_steps = 12;
constexpr double min_step = 0.0125;  // in loss widths; smaller steps end the iteration
constexpr std::array<double, 2> start_radii{2.0 / 3.0, 0.1};  // behind the centroid
constexpr double margin_radii = 0.25;                         // of nearby rays

/// View in double precision, with the rays' directions and lengths.
struct Rays {
  explicit Rays(const BodyView& body_view) : view(body_view) {
    for (const auto& point : view.surface_points) surface_points.push_back(point.cast<double>());
    for (const auto& end : view.free_space_endpoints) {
      const Eigen::Vector3d ray = end.cast<double>() - view.origin_m;
      free_rays.push_back({ray.normalized(), ray.norm()});
    }
  }

  struct Ray {
    Eigen::Vector3d direction;
    double length_m;
  };
  const BodyView& view;
  std::vector<Eigen::Vector3d> surface_points;
  std::vector<Ray> free_rays;
};

/// Vector from the nearest point of a ray to a point, which is relative to the ray's origin.
Eigen::Vector3d offset_from(const Rays::Ray& ray, const Eigen::Vector3d& point) {
  return point - std::clamp(point.dot(ray.direction), 0.0, ray.length_m) * ray.direction;
}

/// Finds the rays that a sphere may enter while its centre moves by less than a margin: most rays
/// pass far from it.
class NearbyRays {
 public:
  NearbyRays(const Rays& rays, double radius_m)
      : rays_(rays), margin_m_(margin_radii * radius_m), reach_m_(1.01 * (radius_m + margin_m_)) {}

  const std::vector<Rays::Ray>& around(const Eigen::Vector3d& centre_from_origin) {
    if ((centre_from_origin - middle_m_).norm() <= margin_m_) return nearby_;
    middle_m_ = centre_from_origin;
    nearby_.clear();
    for (const auto& ray : rays_.free_rays)
      if (offset_from(ray, middle_m_).squaredNorm() < reach_m_ * reach_m_) nearby_.push_back(ray);
    return nearby_;
  }

 private:
  const Rays& rays_;
  double margin_m_, reach_m_;
  Eigen::Vector3d middle_m_ =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());  ///< of nearby_
  std::vector<Rays::Ray> nearby_;
};

/// Calls use(offset, its length, residual, residual_weight) for all surface points and for the rays
/// that enter the sphere. Offset: from the surface point, or the ray's nearest point, to the
/// centre.
template <class Use>
void for_each_residual(const Rays& rays, NearbyRays& nearby, double radius_m,
                       const Eigen::Vector3d& centre, Use&& use) {
  for (const auto& point : rays.surface_points) {
    const Eigen::Vector3d offset = centre - point;
    const double length = offset.norm();
    const Eigen::Vector3d inward = offset / std::max(length, 1e-9);
    use(offset, length, length - radius_m,
        rays.view.residual_weight(inward, point - rays.view.origin_m));
  }
  const Eigen::Vector3d from_origin = centre - rays.view.origin_m;
  const double passing_m =
      std::max(0.0, radius_m - rays.view.pixel_angular_size * from_origin.norm());
  for (const auto& ray : nearby.around(from_origin)) {
    const Eigen::Vector3d offset = offset_from(ray, from_origin);
    const double square = offset.squaredNorm();
    if (square >= passing_m * passing_m) continue;
    const double length = std::sqrt(square);
    use(offset, length, length - passing_m, 1.0);
  }
}

struct CentreEquations {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

CentreEquations centre_equations(const Rays& rays, NearbyRays& nearby, double radius_m,
                                 const Eigen::Vector3d& centre, const GemanMcClureLoss& loss) {
  CentreEquations equations;
  for_each_residual(
      rays, nearby, radius_m, centre,
      [&](const Eigen::Vector3d& offset, double length, double residual, double weight) {
        const double inverse = 1.0 / std::max(length, 1e-9);
        const Eigen::Vector3d weighted =
            loss.weight(weight * residual) * weight * weight * inverse * offset;
        equations.normal.noalias() += inverse * weighted * offset.transpose();
        equations.gradient += residual * weighted;
      });
  return equations;
}

double cost_at(const Rays& rays, NearbyRays& nearby, double radius_m, const Eigen::Vector3d& centre,
               const GemanMcClureLoss& loss) {
  double cost = 0.0;
  for_each_residual(rays, nearby, radius_m, centre,
                    [&](const Eigen::Vector3d&, double, double residual, double weight) {
                      cost += loss.cost(weight * residual);
                    });
  return cost;
}

SphereFit gauss_newton(const Rays& rays, double radius_m, const Eigen::Vector3d& start) {
  NearbyRays nearby(rays, radius_m);
  SphereFit fit;
  fit.centre_m = start;
  for (const double width_m : {coarse_loss_width_m, fine_loss_width_m})
    for (int i = 0; i < max_fit_steps; ++i) {
      const auto equations = centre_equations(rays, nearby, radius_m, fit.centre_m, {width_m});
      fit.information = equations.normal;
      // prior: the start, with the weight of one point, so that the matrix is never singular
      const Eigen::Vector3d step = (equations.normal + Eigen::Matrix3d::Identity())
                                       .ldlt()
                                       .solve(equations.gradient + fit.centre_m - start);
      fit.centre_m -= step;
      if (step.norm() < min_step * width_m) break;
    }
  fit.cost_m2 = cost_at(rays, nearby, radius_m, fit.centre_m, {fine_loss_width_m});
  return fit;
}

}  // namespace

SphereFit fit_sphere(const BodyView& view, double radius_m) {
  const Rays rays(view);
  const Eigen::Vector3d centroid = view.centroid_m();
  const Eigen::Vector3d ray = (centroid - view.origin_m).normalized();
  SphereFit best;
  best.cost_m2 = std::numeric_limits<double>::infinity();
  for (const double part : start_radii) {
    const auto fit = gauss_newton(rays, radius_m, centroid + part * radius_m * ray);
    if (fit.cost_m2 < best.cost_m2) best = fit;
  }
  return best;
}

}  // namespace touchtrace::label
