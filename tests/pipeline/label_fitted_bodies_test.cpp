#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/estimate/fitted_bodies.h"

namespace touchtrace::label {
namespace {

constexpr double unit_m2 = point_sigma_m * point_sigma_m;

/// Box of 20 by 30 mm and a thickness (half extents), with costs of its views and its boxes in
/// squared standard deviations of a point.
FittedBody fitted(double thickness_m, const std::vector<double>& view_costs, double box_cost) {
  FittedBody at{{{0.018, thickness_m - 0.002, 0.028}, 0.002}, {}, 0.0, box_cost * unit_m2};
  for (const double cost : view_costs) {
    at.fits.push_back({});
    at.fits.back().cost_m2 = cost * unit_m2;
    at.cost_m2 += cost * unit_m2;
  }
  return at;
}

const FittedBody best = fitted(0.012, {10.0, 10.0, 10.0, 10.0, 10.0}, 1.0),
                 thin = fitted(0.006, {14.0, 8.0, 12.0, 9.0, 10.0}, 1.0),
                 thick = fitted(0.009, {10.0, 11.0, 12.0, 9.0, 10.0}, 6.9);

TEST(FittedBodies, ViewsThatAgreeRefuteABody) {
  // the sum of five equal differences is sqrt(5) times the root of their squares
  const auto worse = fitted(0.004, {11.0, 11.0, 11.0, 11.0, 11.0}, 1.0);
  EXPECT_EQ(plausible_of({worse, best, thin, thick}).size(), 3u);
}

TEST(FittedBodies, BoxesRefuteABody) {
  const auto beyond = fitted(0.009, {10.0, 11.0, 12.0, 9.0, 10.0}, 7.1);
  EXPECT_EQ(plausible_of({beyond, best, thin}).size(), 2u);
}

TEST(FittedBodies, TheTypicalOneHasTheMedianThickness) {
  EXPECT_EQ(typical_of({best, thin, thick}).cost_m2, thick.cost_m2);
  EXPECT_EQ(smallest_of({best, thin, thick}).cost_m2, thin.cost_m2);
}

TEST(FittedBodies, SpreadIsTheRmsDifferenceOfSizes) {
  EXPECT_NEAR(half_extent_spread_m({best, thin, thick}, thick),
              std::sqrt(2.0 * 0.003 * 0.003 / 9.0), 1e-12);
  auto turned = best;
  std::swap(turned.body.inner_m.x(), turned.body.inner_m.z());
  EXPECT_NEAR(half_extent_spread_m({turned}, best), 0.0, 1e-12);
}

}  // namespace
}  // namespace touchtrace::label
