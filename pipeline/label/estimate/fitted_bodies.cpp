#include "pipeline/label/estimate/fitted_bodies.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

/// Standard deviations of the sum of cost differences over the views, above which they tell two
/// bodies apart.
constexpr double significant_difference = 2.0;
/// Box cost over that of the best body [point_sigma_m^2] above which the boxes refute a body.
constexpr double significant_box_cost = 6.0;

/// Whether the views or their boxes refute a body, given one of smaller cost.
bool is_refuted(const FittedBody& body, const FittedBody& better) {
  if (body.box_cost_m2 - better.box_cost_m2 > significant_box_cost * point_sigma_m * point_sigma_m)
    return true;
  double sum_m2 = 0.0, square_m4 = 0.0;
  for (std::size_t i = 0; i < body.fits.size(); ++i) {
    const double difference_m2 = body.fits[i].cost_m2 - better.fits[i].cost_m2;
    sum_m2 += difference_m2;
    square_m4 += difference_m2 * difference_m2;
  }
  return sum_m2 > significant_difference * std::sqrt(square_m4);
}

Eigen::Vector3d sorted_half_extents_m(const FittedBody& at) {
  Eigen::Vector3d half_m = at.body.half_extents_m();
  std::ranges::sort(half_m);
  return half_m;
}

}  // namespace

FittedBodies plausible_of(const FittedBodies& bodies) {
  const auto best = std::ranges::min_element(bodies, {}, &FittedBody::cost_m2);
  FittedBodies plausible;
  std::ranges::copy_if(bodies, std::back_inserter(plausible),
                       [&](const FittedBody& body) { return !is_refuted(body, *best); });
  return plausible;
}

FittedBody smallest_of(const FittedBodies& bodies) {
  return *std::ranges::min_element(
      bodies, {}, [](const FittedBody& at) { return at.body.half_extents_m().prod(); });
}

FittedBody typical_of(const FittedBodies& bodies) {
  Eigen::Vector3d middle_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> half_m;
    for (const auto& body : bodies) half_m.push_back(sorted_half_extents_m(body)[axis]);
    middle_m[axis] = median(std::move(half_m));
  }
  return *std::ranges::min_element(bodies, {}, [&](const FittedBody& body) {
    return (sorted_half_extents_m(body) - middle_m).norm();
  });
}

double half_extent_spread_m(const FittedBodies& bodies, const FittedBody& learnt) {
  double sum_m2 = 0.0;
  for (const auto& body : bodies)
    sum_m2 += (sorted_half_extents_m(body) - sorted_half_extents_m(learnt)).squaredNorm();
  return std::sqrt(sum_m2 / (3.0 * static_cast<double>(bodies.size())));
}

}  // namespace touchtrace::label
