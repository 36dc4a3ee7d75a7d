#include "calib/rgbd/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "calib/rgbd/projection_map.h"
#include "engine/base/error.h"
#include "tests/verify/calib/monte_carlo.h"
#include "tests/verify/calib/simulated_boards.h"

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
  expect_true_covariance(result.nees, 22, result.runs);
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
  EXPECT_EQ(c.details["lens"], "radtan4");
  EXPECT_EQ(c.details["verdict"], "GOOD");
}

TEST(Calibrate, FindsTheDelayOfTheDepthImages) {
  const SimulatedBoards boards = simulated_moving_boards(12, 0.021);
  RandomStream random(14, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  ASSERT_EQ(c.parameters.back(), "depth.delay");
  const double sigma_s = std::sqrt(c.covariance.diagonal().tail<1>()[0]);
  EXPECT_LT(sigma_s, 2e-3);
  EXPECT_NEAR(c.depth_delay_s, boards.truth.depth_delay_s, 4.5 * sigma_s);
}

TEST(Calibrate, LeavesTheDelayOfABoardAtRestOut) {
  const SimulatedBoards boards = simulated_boards(6, true);
  RandomStream random(15, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  EXPECT_EQ(c.parameters.back(), "depth.offset");
  EXPECT_EQ(c.depth_delay_s, 0.0);
}

/// The corner, the middle of the upper border and the middle of the image are off as predicted.
TEST(Calibrate, KnowsHowWellItProjects) {
  constexpr int runs = 60;
  constexpr Eigen::Index middle = (ImageGrid::rows / 2) * ImageGrid::columns + 4;
  const SimulatedBoards boards = simulated_boards(15, false, 640);
  std::map<Eigen::Index, double> ratio{{0, 0.0}, {4, 0.0}, {middle, 0.0}};
  for (std::uint64_t run = 0; run < runs; ++run) {
    RandomStream random(run, "projection");
    const RgbdCalibration c = calibrate(observe(boards, random), {.lenses = {"radtan4"}});
    const Eigen::MatrixXd sigma = projection_sigma_px(c);
    const Eigen::VectorXd moved = free_of_turns(c) * errors(c, boards.truth).head(8);
    for (auto& [pixel, sum] : ratio) {
      const double deviation = sigma(pixel / ImageGrid::columns, pixel % ImageGrid::columns);
      sum += moved.segment<2>(2 * pixel).squaredNorm() / (2.0 * deviation * deviation * runs);
    }
  }
  // Two directions that may be one: a mean over `runs` of chi^2 with 1 to 2 degrees of freedom.
  for (const auto& [pixel, mean] : ratio) EXPECT_NEAR(mean, 1.0, 4.0 * std::sqrt(2.0 / runs));
}

TEST(Calibrate, IsDeterministic) {
  const SimulatedBoards boards = simulated_boards(8, true);
  RandomStream first(7, "noise"), second(7, "noise");
  const auto a = calibrate(observe(boards, first)), b = calibrate(observe(boards, second));
  EXPECT_EQ(a.color.parameters(), b.color.parameters());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Calibrate, LeavesOutRadialDistortionThatIsNotThere) {
  const SimulatedBoards boards = seen_through(simulated_boards(15, false), Radtan4{}, {});
  RandomStream random(3, "noise");
  EXPECT_EQ(calibrate(observe(boards, random)).details["lens"], "none");
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

struct LensCase {
  const char* name;
  SimulatedBoards boards;
};

/// What each lens would be taken for if the choice went wrong is among the others.
std::vector<LensCase> lens_cases() {
  const SimulatedBoards boards = simulated_boards(20, false, 640);
  const SimulatedBoards wide = simulated_fisheye_boards(20);
  return {{"none", seen_through(boards, Radtan4{}, {})},
          {"radtan4", boards},
          {"radtan5", seen_through(boards, Radtan5{}, {-0.3, 0.3, 0.001, -0.001, -0.5})},
          {"rational8", seen_through(wide, Rational8{},
                                     {0.78, 0.068, 0.001, -0.001, 0.002, 1.11, 0.238, 0.006})},
          {"fisheye4", wide}};
}

class TrueLens : public ::testing::TestWithParam<LensCase> {};

TEST_P(TrueLens, IsChosenByBic) {
  SimulatedBoards boards = GetParam().boards;
  boards.corner_sigma_px = 0.02;
  RandomStream random(4, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  EXPECT_EQ(c.details["lens"], GetParam().name) << c.details["lenses"].dump(1);
  EXPECT_NEAR(c.color.fx, boards.truth.color[0], 4.5 * std::sqrt(c.covariance(0, 0)));
  EXPECT_NEAR(c.color.fy, boards.truth.color[1], 4.5 * std::sqrt(c.covariance(1, 1)));
}

TEST_P(TrueLens, ReachesTheCramerRaoBoundWithATrueCovariance) {
  // Nothing radial is free in "none"; rational8 has coefficients that some draws do not tell.
  if (std::string(GetParam().name) == "none" || std::string(GetParam().name) == "rational8") return;
  SimulatedBoards boards = GetParam().boards;
  boards.corner_sigma_px = 0.05;
  const MonteCarlo result = monte_carlo(boards, 60);
  const auto parameters = static_cast<int>(intrinsic_names(boards.truth.lens).size());
  expect_true_covariance(result.color_nees, parameters, result.runs);
  expect_efficient(result);
}

INSTANTIATE_TEST_SUITE_P(Lenses, TrueLens, ::testing::ValuesIn(lens_cases()),
                         [](const auto& lens) { return lens.param.name; });

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

void expect_refused(const BoardObservations& observed, const std::string& naming) {
  try {
    calibrate(observed);
    FAIL() << "accepted what should name " << naming;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    EXPECT_NE(std::string(error.what()).find(naming), std::string::npos) << error.what();
  }
}

TEST(Calibrate, RefusesTooFewViews) {
  expect_refused(simulated_boards(1, false).clean, "in 1 views");
  expect_refused(simulated_boards(2, false).clean, "in 2 views");
}

TEST(Calibrate, NamesAViewFromBehind) {
  BoardObservations observed = simulated_boards(6, false).clean;
  for (auto& corner : observed.views[3].corners_px) corner.x() = observed.width - 1 - corner.x();
  expect_refused(observed, "view 3");
}

TEST(Calibrate, NamesAViewWithACornerThatIsNoNumber) {
  BoardObservations observed = simulated_boards(6, false).clean;
  observed.views[2].corners_px[7].y() = std::nan("");
  expect_refused(observed, "view 2");
  observed.views[2].corners_px[7].y() = std::numeric_limits<double>::infinity();
  expect_refused(observed, "view 2");
}

TEST(Calibrate, CountsAViewThatIsThereTwiceOnce) {
  const SimulatedBoards boards = simulated_boards(10, false);
  RandomStream random(10, "noise");
  const BoardObservations once = observe(boards, random);
  BoardObservations twice = once;
  twice.views.insert(twice.views.end(), once.views.begin(), once.views.end());
  const RgbdCalibration a = calibrate(once), b = calibrate(twice);
  EXPECT_EQ(b.details["duplicate_views"].size(), 10u);
  EXPECT_NEAR(b.covariance(0, 0), a.covariance(0, 0), 0.2 * a.covariance(0, 0));
  BoardObservations one = once;
  one.views.assign(6, once.views[0]);
  expect_refused(one, "in 1 views");
}

TEST(Calibrate, ATinyImageIsBadOrRefused) {
  BoardObservations observed = simulated_boards(8, false).clean;
  for (auto& view : observed.views)
    for (auto& corner : view.corners_px) corner = corner.array().round() / 40.0;
  observed.width = 8, observed.height = 6;
  try {
    EXPECT_NE(calibrate(observed).details["verdict"], "GOOD");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
  }
}

TEST(Calibrate, FindsTheBoardsWarp) {
  SimulatedBoards boards = warped(simulated_boards(15, false, 640), {8e-4, -5e-4});
  RandomStream random(11, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  const Eigen::VectorXd error = errors(c, boards.truth);
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 4.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

TEST(Calibrate, LeavesOutCoefficientsThatTheDataDoNotTell) {
  const SimulatedBoards boards = simulated_boards(12, false, 640);
  RandomStream random(12, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random), {.lenses = {"rational8"}});
  const auto& removed = c.details["lenses"][0]["removed"];
  ASSERT_FALSE(removed.empty());
  EXPECT_EQ(removed[0]["parameter"], "k6");
  EXPECT_EQ(c.color.distortion[7], 0.0);
  EXPECT_NEAR(c.color.fx, boards.truth.color[0], 4.5 * std::sqrt(c.covariance(0, 0)));
}

TEST(Calibrate, HeldOutViewsFitAlmostAsWell) {
  const SimulatedBoards boards = simulated_boards(15, false);
  RandomStream random(13, "noise");
  const auto c = calibrate(observe(boards, random), {.cross_validate = true});
  const auto& held_out = c.details["held_out"];
  const double ratio = held_out["held_out_rms_px"].get<double>() / c.rms_px;
  EXPECT_GT(ratio, 1.0);  // each fold fits its own poses, so only the camera's error adds to it
  EXPECT_LT(ratio, 1.1);
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
