#include "calib/rgbd/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/rgbd/monte_carlo.h"
#include "calib/rgbd/simulated_boards.h"
#include "engine/base/error.h"

namespace touchtrace {
namespace {

/// The mean of `runs` draws of chi^2 with n degrees of freedom over n: 1 within 4 sqrt(2 / (n
/// runs)).
void expect_true_covariance(double nees, int parameters, int runs) {
  EXPECT_NEAR(nees, 1.0, 4.0 * std::sqrt(2.0 / (parameters * runs)));
}

/// RMSE over its bound from `runs` draws: 1 within 4 sqrt(1 / (2 runs)).
void expect_efficient(const MonteCarlo& result) {
  for (std::size_t i = 0; i < result.names.size(); ++i)
    EXPECT_NEAR(result.rmse_ratio[i], 1.0, 4.0 / std::sqrt(2.0 * result.runs)) << result.names[i];
}

class ColorNoise : public ::testing::TestWithParam<double> {};

TEST_P(ColorNoise, ReachesTheCramerRaoBoundWithATrueCovariance) {
  SimulatedBoards boards = simulated_boards(15, false);
  boards.corner_sigma_px = GetParam();
  const MonteCarlo result = monte_carlo(boards, 60);
  expect_true_covariance(result.color_nees, 8, result.runs);
  expect_efficient(result);
}

INSTANTIATE_TEST_SUITE_P(Pixels, ColorNoise, ::testing::Values(0.001, 0.1, 0.5));

TEST(Calibrate, DepthReachesTheCramerRaoBoundWithATrueCovariance) {
  const MonteCarlo result = monte_carlo(simulated_boards(15, true), 40);
  expect_true_covariance(result.nees, 20, result.runs);
  expect_efficient(result);
}

TEST(Calibrate, FindsTheTruthWithoutNoise) {
  SimulatedBoards boards = simulated_boards(12, true);
  boards.corner_sigma_px = 0.0, boards.depth_sigma_at_1m = 0.0;
  const RgbdCalibration c = calibrate(boards.clean);
  // Depth images are float32: 6e-8 of 0.9 m. The weakest direction amplifies it by less than 1e3.
  EXPECT_NEAR(c.color.fx, boards.truth.color[0], 1e-4);
  EXPECT_NEAR(c.color.cy, boards.truth.color[3], 1e-4);
  EXPECT_NEAR(c.depth_scale, boards.truth.depth_correction[0], 1e-4);
  EXPECT_NEAR(c.depth_offset_m, boards.truth.depth_correction[1], 1e-4);
  EXPECT_NEAR(c.depth_from_color.translation().x(), boards.truth.depth_from_color[3], 1e-4);
  EXPECT_EQ(c.details["radial_coefficients"], 2);
  EXPECT_EQ(c.details["verdict"], "GOOD");
}

TEST(Calibrate, IsDeterministic) {
  const SimulatedBoards boards = simulated_boards(8, true);
  RandomStream first(7, "noise"), second(7, "noise");
  const auto a = calibrate(observe(boards, first)), b = calibrate(observe(boards, second));
  EXPECT_EQ(a.color.parameters(), b.color.parameters());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Calibrate, LeavesOutRadialDistortionThatIsNotThere) {
  const SimulatedBoards boards = with_distortion(simulated_boards(15, false), {});
  RandomStream random(3, "noise");
  EXPECT_EQ(calibrate(observe(boards, random)).details["radial_coefficients"], 0);
}

TEST(Calibrate, NamesAnOutlierViewAndDoesWithoutIt) {
  SimulatedBoards boards = simulated_boards(15, true);
  RandomStream random(5, "noise");
  BoardObservations observed = observe(boards, random);
  for (auto& corner : observed.views[4].corners_px)
    corner += 3.0 * Eigen::Vector2d(random.normal(), random.normal());
  const RgbdCalibration c = calibrate(observed);
  EXPECT_EQ(c.details["outlier_views"], nlohmann::json::array({"view 4"}));
  const Eigen::VectorXd error = errors(c, boards.truth);
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 4.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

TEST(Calibrate, DepthOfSomethingBeforeTheBoardDoesNotCount) {
  constexpr double thumb_px = 25.0;
  const SimulatedBoards boards = simulated_boards(15, true);
  RandomStream random(6, "noise");
  BoardObservations observed = observe(boards, random);
  for (auto& view : observed.views)
    for (int y = 0; y < observed.height; ++y)
      for (int x = 0; x < observed.width; ++x)
        if ((Eigen::Vector2d(x, y) - view.corners_px[0]).norm() < thumb_px)
          view.depth_m[static_cast<std::size_t>(y * observed.width + x)] *= 0.93f;
  const RgbdCalibration c = calibrate(observed);
  const Eigen::VectorXd error = errors(c, boards.truth);
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 4.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

/// Views that all look straight at the board say nothing of the focal length.
BoardObservations frontal_views() {
  BoardObservations observed = simulated_boards(10, false).clean;
  RandomStream random(8, "noise");
  for (auto& view : observed.views) {
    const Eigen::Vector2d start(random.uniform(40, 80), random.uniform(40, 80));
    const double square_px = random.uniform(15, 18);
    for (int i = 0; i < observed.board.corners(); ++i)
      view.corners_px[static_cast<std::size_t>(i)] =
          start +
          square_px * Eigen::Vector2d(i % observed.board.columns, i / observed.board.columns) +
          0.1 * Eigen::Vector2d(random.normal(), random.normal());
  }
  return observed;
}

TEST(Calibrate, FrontalViewsAreBadOrRefused) {
  try {
    const RgbdCalibration c = calibrate(frontal_views());
    EXPECT_EQ(c.details["verdict"], "BAD");
    EXPECT_NE(c.details["advice"].dump().find("tilt the board"), std::string::npos);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
  }
}

TEST(Calibrate, RefusesTooFewViews) {
  BoardObservations observed = simulated_boards(2, false).clean;
  try {
    calibrate(observed);
    FAIL() << "accepted two views";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    EXPECT_NE(std::string(error.what()).find("in 2 views"), std::string::npos);
  }
}

TEST(Calibrate, NamesAViewFromBehind) {
  BoardObservations observed = simulated_boards(6, false).clean;
  for (auto& corner : observed.views[3].corners_px) corner.x() = observed.width - 1 - corner.x();
  try {
    calibrate(observed);
    FAIL() << "accepted a mirrored view";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    EXPECT_NE(std::string(error.what()).find("view 3"), std::string::npos);
  }
}

TEST(Calibrate, DoesNotDependOnTheUnitOfLength) {
  SimulatedBoards boards = simulated_boards(12, false);
  RandomStream random(9, "noise");
  BoardObservations metres = observe(boards, random), millimetres = metres;
  millimetres.board.square_m *= 1000.0;
  const auto a = calibrate(metres), b = calibrate(millimetres);
  // Both stop within 1e-10 of the cost of their minimum: 1e-5 sqrt(2 cost) ~ 4e-4 deviations at
  // most.
  EXPECT_NEAR(a.color.fx, b.color.fx, 4e-4 * std::sqrt(a.covariance(0, 0)));
}

}  // namespace
}  // namespace touchtrace
