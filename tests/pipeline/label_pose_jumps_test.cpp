#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/estimate/pose_jumps.h"

namespace touchtrace::label {
namespace {

constexpr int num_views = 60;
constexpr double period_s = 1.0 / 30.0, sigma_m = 0.02, jump_m = 0.08;
const Eigen::Vector3d start_m(0.1, 0.0, 1.0);

/// Views in which centre and visible surface move by the same `path(i)`.
template <class Path>
std::vector<PosedView> views_of(Path&& path) {
  std::vector<PosedView> views;
  for (int i = 0; i < num_views; ++i) {
    const Eigen::Vector3d moved = path(i);
    views.push_back({period_s * i, start_m + moved, Eigen::Vector3d::Constant(sigma_m),
                     start_m + moved - Eigen::Vector3d(0.0, 0.0, 0.1)});
  }
  return views;
}

std::vector<PosedView> still_views() {
  return views_of([](int i) { return Eigen::Vector3d(0.001 * i, 0.0, 0.0); });
}

std::vector<double> sigmas_x_m(const std::vector<PosedView>& views) {
  std::vector<double> sigmas;
  for (const auto& variance : jump_variances(views)) sigmas.push_back(std::sqrt(variance.x()));
  return sigmas;
}

double max_variance(const std::vector<PosedView>& views) {
  double largest = 0.0;
  for (const auto& variance : jump_variances(views))
    largest = std::max(largest, variance.maxCoeff());
  return largest;
}

/// One of the two places is wrong: each view is off by 0 or by the jump.
TEST(PoseJumps, WidenAllViewsOfABodyThatIsAtTwoPlaces) {
  auto views = still_views();
  for (int i = num_views / 2; i < num_views; ++i) views[std::size_t(i)].centre_m.x() += jump_m;
  for (const double sigma : sigmas_x_m(views)) EXPECT_NEAR(sigma, jump_m / std::sqrt(2.0), 0.002);
}

TEST(PoseJumps, WidenASingleViewAtAnotherPlace) {
  auto views = still_views();
  views[20].centre_m.x() += jump_m;
  const auto sigmas = sigmas_x_m(views);
  EXPECT_NEAR(sigmas[20], jump_m, 0.003);
  EXPECT_LT(sigmas[10], 0.012);
  EXPECT_LT(sigmas[40], 0.012);
}

TEST(PoseJumps, AreNotTheMotionOfAHand) {
  const double turn_rad_per_s = 6.0, radius_m = 0.4;  // 2.4 m/s, 14 m/s^2
  const auto swing = [&](int i) {
    const double angle = turn_rad_per_s * period_s * i;
    return radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  };
  EXPECT_EQ(max_variance(views_of(swing)), 0.0);
  auto partly_visible = views_of(swing);  // the visible end moves otherwise than the centre
  for (int i = 0; i < num_views; ++i)
    partly_visible[std::size_t(i)].visible_centroid_m = start_m + 0.3 * swing(i);
  EXPECT_EQ(max_variance(partly_visible), 0.0);
  const auto bounce =
      views_of([](int i) { return Eigen::Vector3d(0.0, 0.1 * std::abs(i - 30), 0.0); });  // 3 m/s
  EXPECT_EQ(max_variance(bounce), 0.0);
}

TEST(PoseJumps, AreStepsBeyondTheStatedDeviation) {
  auto views = still_views();
  for (int i = 30; i < num_views; ++i) views[std::size_t(i)].centre_m.x() += jump_m;
  views[30].sigma_m.x() = jump_m;
  EXPECT_EQ(max_variance(views), 0.0);
  views = still_views();
  for (int i = 30; i < num_views; ++i) views[std::size_t(i)].centre_m.x() += jump_m;
  for (int i = 30; i < num_views; ++i) views[std::size_t(i)].time_s += 1.0;
  EXPECT_EQ(max_variance(views), 0.0) << "not seen for a second";
  EXPECT_TRUE(jump_variances({}).empty());
}

}  // namespace
}  // namespace touchtrace::label
