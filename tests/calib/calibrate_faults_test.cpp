// Views that are not what they should be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/board/board_detector.h"
#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/verdict.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

std::string advice_of(const RgbdCalibration& c) { return c.details["advice"].dump(); }

/// The same photographs encoded twice: noise of .05 px, far below what a view may differ by.
TEST(CalibrateFaults, CountsReEncodedViewsOnce) {
  RandomStream random(16, "noise");
  const BoardObservations once = observe(simulated_boards(10, false), random);
  BoardObservations twice = once;
  for (auto view : once.views) {
    for (auto& corner : view.corners_px)
      corner += 0.05 * Eigen::Vector2d(random.normal(), random.normal());
    twice.views.push_back(view);
  }
  EXPECT_EQ(calibrate(twice).details["duplicate_views"].size(), 10u);
}

/// The images are stretched by 3.7 %, which a radial lens takes up in part: hence 3.x.
TEST(CalibrateFaults, ABoardWhoseSquaresAreNotSquareIsNotGood) {
  SimulatedBoards boards = simulated_boards(15, false, 640);
  BoardObservations observed = observe(boards, 17);
  for (auto& view : observed.views)
    for (auto& corner : view.corners_px) corner.y() *= 1.037;
  observed.height = static_cast<int>(1.037 * observed.height);
  const RgbdCalibration c = calibrate(observed);
  EXPECT_EQ(c.details["verdict"], "WEAK");
  EXPECT_NE(advice_of(c).find("fy differs from fx by +3."), std::string::npos) << advice_of(c);
}

TEST(CalibrateFaults, BlurredImagesAreNotGood) {
  BoardObservations observed = observe(simulated_boards(15, false, 640), 20);
  for (auto& view : observed.views) view.relative_edge_width = 0.2;
  EXPECT_EQ(calibrate(observed).details["verdict"], "GOOD");
  for (auto& view : observed.views) view.relative_edge_width = 0.4;
  const RgbdCalibration c = calibrate(observed);
  EXPECT_EQ(c.details["verdict"], "WEAK");
  EXPECT_NE(advice_of(c).find("edges are as wide as 40 % of a square"), std::string::npos);
}

/// A board of 9x5 corners looks the same after half a turn; the detector begins at either end.
TEST(CalibrateFaults, TurnsViewsOfASymmetricBoardTheSameWay) {
  BoardObservations observed = observe(simulated_boards(10, false), 19);
  observed.board.rows = 5;  // without the last of six rows
  for (auto& view : observed.views) view.corners_px.resize(45);
  BoardObservations turned = observed;
  for (std::size_t i = 1; i < turned.views.size(); i += 2)
    std::ranges::reverse(turned.views[i].corners_px);
  const RgbdCalibration a = calibrate(observed), b = calibrate(turned);
  EXPECT_EQ(a.color.parameters(), b.color.parameters());
}

/// Every second view is from a camera whose focal length and centre are `scale` times as large.
BoardObservations two_cameras(const SimulatedBoards& boards, double scale) {
  BoardObservations observed = observe(boards, 18);
  for (std::size_t i = 0; i < observed.views.size(); i += 2)
    for (auto& corner : observed.views[i].corners_px) corner *= scale;
  return observed;
}

/// A spread of 1 % about the mean, which the standard deviation of some 16 views has to cover. The
/// verdict may be GOOD.
TEST(CalibrateFaults, StatedErrorsCoverTwoCamerasInOneFolder) {
  const SimulatedBoards boards = simulated_boards(16, false, 640);
  const RgbdCalibration c = calibrate(two_cameras(boards, 1.02));
  EXPECT_GT(c.details["view_inflation"].get<double>(), 2.0);
  EXPECT_GT(4.5 * std::sqrt(c.covariance(0, 0)), std::abs(c.color.fx - boards.truth.color[0]));
}

TEST(CalibrateFaults, TwoCamerasThatDifferByATwentiethAreNotGood) {
  const RgbdCalibration c = calibrate(two_cameras(simulated_boards(16, false, 640), 1.05));
  EXPECT_NE(c.details["verdict"], "GOOD");
  EXPECT_NE(advice_of(c).find("the views contradict each other"), std::string::npos)
      << advice_of(c) << c.details["view_inflation"];
}

/// Camera of 640x480 pixels whose distortion r (1 - 0.3 r^2) can be inverted up to r = 1.054, which
/// is at 140 px from the centre.
RgbdCalibration lens_that_folds() {
  RgbdCalibration c;
  c.color = {.width = 640, .height = 480, .fx = 200, .fy = 200, .cx = 320, .cy = 240};
  c.color.lens = Radtan4{};
  c.color.distortion[0] = -0.3;
  c.parameters = {"color.fx", "color.fy", "color.cx", "color.cy"};
  c.covariance = 1e-4 * Eigen::Matrix4d::Identity();
  return c;
}

TEST(CalibrateFaults, PixelsWhereTheLensCannotBeInvertedAreUnknown) {
  RgbdCalibration c = lens_that_folds();
  EXPECT_TRUE(std::isinf(projection_sigma_quantile_px(c, judged_image_fraction)));
  const Verdict verdict = assess_calibration(c, {.used = 20});
  EXPECT_EQ(verdict.grade, Grade::bad);
  EXPECT_NE(nlohmann::json(verdict.advice).dump().find("the lens cannot be inverted there"),
            std::string::npos);
}

TEST(CalibrateFaults, PixelsThatAreBlackInAllImagesAreNotJudged) {
  RgbdCalibration c = lens_that_folds();
  c.lit = projection_sigma_px(c).array().isFinite();
  EXPECT_LT(projection_sigma_quantile_px(c, judged_image_fraction), 0.02);
  EXPECT_EQ(assess_calibration(c, {.used = 20}).grade, Grade::good);
}

TEST(CalibrateFaults, TheDetectorTellsBlackPartsOfTheImages) {
  BoardDetector detector(CalibrationTarget{});
  GreyImage image{640, 480, std::vector<std::uint8_t>(640 * 480, 4)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (i % 640 >= 320) image.pixels[i] = 100;
  detector.add({.name = "right half"}, image);
  const BoardObservations observed = std::move(detector).finish();
  EXPECT_FALSE(observed.lit.leftCols<4>().any());
  EXPECT_TRUE(observed.lit.rightCols<4>().all());
}

/// A rational lens can imitate a fisheye up to some 80 degrees, if it is started near the solution.
TEST(CalibrateFaults, FitsAPerspectiveLensToAFisheye) {
  const SimulatedBoards boards = simulated_fisheye_boards(25);
  const RgbdCalibration c = calibrate(observe(boards, 21), {.lenses = {"rational8"}});
  EXPECT_LT(c.rms_px, 0.2);  // noise: .14
  EXPECT_NEAR(c.color.cx, boards.truth.color[2], 1.0);
  EXPECT_NEAR(c.color.cy, boards.truth.color[3], 1.0);
}

TEST(Verdict, BoardModelsThatDisagreeByMoreThanTheirSigmaAreNotGood) {
  RgbdCalibration c = calibrate(observe(simulated_boards(15, false, 640), 21));
  ASSERT_EQ(c.details["verdict"], "GOOD");
  c.covariance *= 0.25;
  const double allowed_px = 0.005 * c.color.width;
  ASSERT_LT(4.0 * parameter_sigma(c, "color.cy"), allowed_px);
  const auto verdict_of = [&](double change_px) {
    return assess_calibration(c, {.used = 20, .board_model_change_px = {0, 0, 0, change_px}});
  };
  EXPECT_EQ(verdict_of(0.9 * allowed_px).grade, Grade::good);
  const Verdict verdict = verdict_of(1.1 * allowed_px);
  EXPECT_EQ(verdict.grade, Grade::weak);
  ASSERT_EQ(verdict.advice.size(), 1u);
  EXPECT_NE(verdict.advice[0].find("move cy by +3.5 px"), std::string::npos) << verdict.advice[0];
}

}  // namespace
}  // namespace touchtrace
