#include "pipeline/label/estimate/learn_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/parabola.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/estimate/body_fit.h"
#include "pipeline/label/estimate/learn_body.h"
#include "pipeline/label/estimate/sphere_fit.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_body_views = 32, max_body_points = 500;
constexpr double body_reach_radii = 1.5;
constexpr double sphere_noise_ratio = 3.0;
/// Error of a sphere's centre along an image axis per unevenness, for an ellipsoid of which the
/// part within 60 degrees of the line of sight is visible.
constexpr double sphere_centre_per_unevenness = 2.7;
constexpr double disc_fraction_within_60_degrees = 0.75;
/// Accuracy of a sphere's unevenness, from which the sensor's noise is subtracted: a hidden egg
/// looks like a sphere. Chosen on four balls and three eggs of simulated scenes.
constexpr double unevenness_sigma_m = 0.0001;
/// Error of a body's centre per unevenness, all extents visible: RMS over the axes of twelve
/// simulated recordings of cans, boxes, cubes and soaps, with their true calibrations.
constexpr double body_centre_per_unevenness = 0.7;
constexpr double max_sphere_unevenness_m = 0.0015;
constexpr double max_body_ratio = 0.33;  // a body's unevenness over the sphere's

double fit_cost(const std::vector<BodyView>& views, double radius_m) {
  double cost = 0.0;
  for (const auto& view : views) cost += fit_sphere(view, radius_m).cost_m2;
  return cost;
}

/// Views with at least the noise ratio of a smooth sphere, whose points err in depth only. Without
/// it a sphere's radius comes out 1 to 2 % too small.
std::vector<BodyView> with_sphere_noise(std::vector<BodyView> views) {
  for (auto& view : views) view.noise_ratio = std::max(view.noise_ratio, sphere_noise_ratio);
  return views;
}

std::vector<double> fit_costs(const std::vector<BodyView>& views,
                              const std::vector<double>& radii_m, int num_threads) {
  std::vector<double> costs(radii_m.size());
  parallel_for(radii_m.size(), num_threads,
               [&](std::size_t i) { costs[i] = fit_cost(views, radii_m[i]); });
  return costs;
}

/// Vertex of the parabola through the smallest cost and its neighbours, in steps from the smallest.
double vertex(const std::vector<double>& costs, std::size_t smallest) {
  if (smallest == 0 || smallest + 1 == costs.size()) return 0.0;
  const double steps = parabola_vertex(costs[smallest - 1], costs[smallest], costs[smallest + 1]);
  return std::isfinite(steps) ? steps : 0.0;
}

/// Radius of the sphere with the smallest cost over all views: a grid search between 0.6 and 1.4
/// silhouette radii, coarse, then in steps of 2 %, refined by a parabola.
double fitted_radius(const std::vector<BodyView>& views, double silhouette_m, int num_threads) {
  constexpr int steps = 50, lowest = 30, highest = 70, coarse = 4;
  const auto best_of = [&](int first, int last, int stride) {
    std::vector<double> radii_m;
    for (int i = first; i <= last; i += stride) radii_m.push_back(silhouette_m / steps * i);
    const auto costs = fit_costs(views, radii_m, num_threads);
    const auto best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
    return first + stride * (static_cast<double>(best) + vertex(costs, best));
  };
  const int near = static_cast<int>(std::lround(best_of(lowest, highest, coarse)));
  return silhouette_m / steps *
         best_of(std::max(lowest, near - coarse + 1), std::min(highest, near + coarse - 1), 1);
}

using Distances = std::vector<double>;

Distances distances_from_sphere(const BodyView& view, double radius_m) {
  const Eigen::Vector3d centre = fit_sphere(view, radius_m).centre_m;
  Distances result;
  for (const auto& measured : view.surface_points) {
    const Eigen::Vector3d point = measured.cast<double>(), offset = point - centre;
    result.push_back(view.residual_weight(offset.normalized(), point - view.origin_m) *
                     (offset.norm() - radius_m));
  }
  return result;
}

Distances distances_from_fitted_body(const BodyView& view, const RoundedBody& body) {
  const auto sample = subsample(view, initial_centre(view, body),
                                body_reach_radii * body.circumradius_m(), max_body_points);
  const Eigen::Isometry3d body_from_camera =
      fit_body_globally(sample, body).camera_from_body.inverse();
  Distances result;
  const Eigen::Vector3d origin = body_from_camera * view.origin_m;
  for (const auto& measured : view.surface_points) {
    const Eigen::Vector3d point = body_from_camera * measured.cast<double>();
    const auto surface = surface_distance(body, point);
    result.push_back(view.residual_weight(surface.outward, point - origin) * surface.distance_m);
  }
  return result;
}

/// Robust standard deviation of the weighted distances over all views.
template <class DistancesOf>
double deviation(const std::vector<BodyView>& views, int num_threads, DistancesOf&& distances_of) {
  std::vector<Distances> by_view(views.size());
  parallel_for(views.size(), num_threads,
               [&](std::size_t i) { by_view[i] = distances_of(views[i]); });
  Distances all;
  for (const auto& some : by_view) all.insert(all.end(), some.begin(), some.end());
  return robust_sigma(std::move(all));
}

double without_noise(double deviation_m) {
  return std::sqrt(
      std::max(0.0, deviation_m * deviation_m - reference_depth_sigma_m * reference_depth_sigma_m));
}

/// Visible area, up to a constant factor.
double visible_area(const BodyView& view) {
  const Eigen::Vector3d point = view.surface_points[view.surface_points.size() / 2].cast<double>();
  return static_cast<double>(view.surface_points.size()) * (point - view.origin_m).squaredNorm();
}

/// Views with boxes, then those with the largest visible area: a body that is mostly hidden fits
/// wrong poses.
std::vector<BodyView> clearest_of(std::vector<BodyView> views) {
  std::ranges::stable_sort(views, std::ranges::greater(), [](const BodyView& view) {
    return std::pair(view.has_box_planes(), visible_area(view));
  });
  views.resize(std::min(views.size(), max_body_views));
  return views;
}

}  // namespace

ObjectShape learn_shape(const std::vector<BodyView>& views, double silhouette_m, int num_threads) {
  const double radius_m = fitted_radius(with_sphere_noise(views), silhouette_m, num_threads);
  const double unevenness_m = without_noise(deviation(
      views, num_threads, [&](const BodyView& v) { return distances_from_sphere(v, radius_m); }));
  const ObjectShape sphere{
      radius_m, std::nullopt, unevenness_m,
      sphere_centre_per_unevenness * std::hypot(unevenness_m, unevenness_sigma_m)};
  if (unevenness_m < max_sphere_unevenness_m) return sphere;
  const auto clearest = clearest_of(views);
  const auto [body, half_extent_sigma_m] = learn_body(clearest, radius_m, num_threads);
  const double deviation_m = deviation(
      clearest, num_threads,
      [&, &learnt = body](const BodyView& v) { return distances_from_fitted_body(v, learnt); });
  if (without_noise(deviation_m) > max_body_ratio * unevenness_m) return sphere;
  return {radius_m, body, deviation_m,
          std::hypot(body_centre_per_unevenness * deviation_m, half_extent_sigma_m)};
}

double hidden_sphere_centre_sigma_m(const ObjectShape& sphere, double fraction,
                                    double box_radius_m) {
  const double squared_width = std::min(1.0, fraction / disc_fraction_within_60_degrees);
  return std::hypot(sphere.centre_sigma_m / (squared_width * squared_width),
                    sphere.radius_m - box_radius_m);
}

}  // namespace touchtrace::label
