#include "pipeline/label/learn_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/base/parabola.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/body_fit.h"
#include "pipeline/label/learn_body.h"
#include "pipeline/label/sphere_fit.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t most_body_views = 32, body_points = 500;
constexpr double body_passing_radii = 1.5;
constexpr double smooth_noise_ratio = 3.0;
/// Of the part of a sphere that lies within 60 degrees of the ray to it, uneven as an ellipsoid is:
/// how far off its middle comes out, along an axis of the image, for what is left.
constexpr double middle_per_unevenness = 2.7;
/// Of a body whose extents are all seen: how far off its middle comes out for how far its surface
/// lies off (RMS over the axes of twelve simulated recordings of cans, boxes, cubes and soaps, by
/// their true calibrations).
constexpr double middle_per_deviation = 0.7;
constexpr double uneven_m = 0.0015;   // no sphere is so rough
constexpr double much_better = 0.33;  // part of the sphere's unevenness

double fit_cost(const std::vector<BodyView>& views, double radius_m) {
  double cost = 0.0;
  for (const auto& view : views) cost += fit_sphere(view, radius_m).cost_m2;
  return cost;
}

/// As of a smooth sphere, where little else is wrong with a point than its depth: with weights that
/// do not know that, its radius comes out 1 to 2 % too small.
std::vector<BodyView> smooth_in(std::vector<BodyView> views) {
  for (auto& view : views) view.noise_ratio = std::max(view.noise_ratio, smooth_noise_ratio);
  return views;
}

/// How well spheres of `radii_m` fit all views.
std::vector<double> fit_costs(const std::vector<BodyView>& views,
                              const std::vector<double>& radii_m, int threads) {
  std::vector<double> costs(radii_m.size());
  parallel_for(radii_m.size(), threads,
               [&](std::size_t i) { costs[i] = fit_cost(views, radii_m[i]); });
  return costs;
}

/// Where the parabola through a least cost and its neighbours is least, in steps from there.
double vertex(const std::vector<double>& costs, std::size_t least) {
  if (least == 0 || least + 1 == costs.size()) return 0.0;
  const double vertex = parabola_vertex(costs[least - 1], costs[least], costs[least + 1]);
  return std::isfinite(vertex) ? vertex : 0.0;
}

/// The radius of the sphere that fits all views best, near that of the silhouette: between `steps`
/// per silhouette's radius, by way of every fourth.
double fitted_radius(const std::vector<BodyView>& views, double silhouette_m, int threads) {
  constexpr int steps = 50, least = 30, most = 70, coarse = 4;
  const auto best_of = [&](int first, int last, int stride) {
    std::vector<double> radii_m;
    for (int i = first; i <= last; i += stride) radii_m.push_back(silhouette_m / steps * i);
    const auto costs = fit_costs(views, radii_m, threads);
    const auto best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
    return first + stride * (static_cast<double>(best) + vertex(costs, best));
  };
  const int near = static_cast<int>(std::lround(best_of(least, most, coarse)));
  return silhouette_m / steps *
         best_of(std::max(least, near - coarse + 1), std::min(most, near + coarse - 1), 1);
}

using Distances = std::vector<double>;

Distances from_sphere(const BodyView& view, double radius_m) {
  const Eigen::Vector3d center = fit_sphere(view, radius_m).center_m;
  Distances result;
  for (const auto& seen : view.on_m) {
    const Eigen::Vector3d point = seen.cast<double>(), off = point - center;
    result.push_back(view.counted_part(off.normalized(), point - view.eye_m) *
                     (off.norm() - radius_m));
  }
  return result;
}

Distances from_body(const BodyView& view, const RoundedBody& body) {
  const auto some = thinned(view, likely_center(view, body),
                            body_passing_radii * body.circumradius_m(), body_points);
  const Eigen::Isometry3d body_from_camera = fit_body_anyhow(some, body).camera_from_body.inverse();
  Distances result;
  const Eigen::Vector3d eye = body_from_camera * view.eye_m;
  for (const auto& seen : view.on_m) {
    const Eigen::Vector3d point = body_from_camera * seen.cast<double>();
    const auto surface = surface_distance(body, point);
    result.push_back(view.counted_part(surface.outward, point - eye) * surface.distance_m);
  }
  return result;
}

/// How far points are from a shape, as far as that counts.
template <class DistancesOf>
double deviation(const std::vector<BodyView>& views, int threads, DistancesOf&& distances_of) {
  std::vector<Distances> of_views(views.size());
  parallel_for(views.size(), threads, [&](std::size_t i) { of_views[i] = distances_of(views[i]); });
  Distances all;
  for (const auto& some : of_views) all.insert(all.end(), some.begin(), some.end());
  return robust_sigma(std::move(all));
}

double beyond_noise(double deviation_m) {
  return std::sqrt(
      std::max(0.0, deviation_m * deviation_m - usual_depth_sigma_m * usual_depth_sigma_m));
}

/// Up to a factor, the area that a view shows.
double shown_area(const BodyView& view) {
  const Eigen::Vector3d middle = view.on_m[view.on_m.size() / 2].cast<double>();
  return static_cast<double>(view.on_m.size()) * (middle - view.eye_m).squaredNorm();
}

/// Those in which all of it is marked, and those that show most: what a hand leaves to be seen fits
/// poses that it is not in.
std::vector<BodyView> clearest_of(std::vector<BodyView> views) {
  std::ranges::stable_sort(views, std::ranges::greater(), [](const BodyView& view) {
    return std::pair(view.is_marked(), shown_area(view));
  });
  views.resize(std::min(views.size(), most_body_views));
  return views;
}

}  // namespace

ObjectShape learn_shape(const std::vector<BodyView>& views, double silhouette_m, int threads) {
  const double radius_m = fitted_radius(smooth_in(views), silhouette_m, threads);
  const double unevenness_m = beyond_noise(
      deviation(views, threads, [&](const BodyView& view) { return from_sphere(view, radius_m); }));
  const ObjectShape sphere{radius_m, std::nullopt, unevenness_m,
                           middle_per_unevenness * unevenness_m};
  if (unevenness_m < uneven_m) return sphere;
  const auto few = clearest_of(views);
  const auto [body, half_extent_sigma_m] = learn_body(few, radius_m, threads);
  const double deviation_m = deviation(
      few, threads, [&, &body = body](const BodyView& view) { return from_body(view, body); });
  if (beyond_noise(deviation_m) > much_better * unevenness_m) return sphere;
  return {radius_m, body, deviation_m,
          std::hypot(middle_per_deviation * deviation_m,
                     half_extent_sigma_m.norm() / std::numbers::sqrt3)};
}

}  // namespace touchtrace::label
