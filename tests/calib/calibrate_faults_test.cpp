// Views that are not what they should be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/rgbd/calibrate.h"
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
  RandomStream random(17, "noise");
  BoardObservations observed = observe(boards, random);
  for (auto& view : observed.views)
    for (auto& corner : view.corners_px) corner.y() *= 1.037;
  observed.height = static_cast<int>(1.037 * observed.height);
  const RgbdCalibration c = calibrate(observed);
  EXPECT_EQ(c.details["verdict"], "WEAK");
  EXPECT_NE(advice_of(c).find("fy differs from fx by +3."), std::string::npos) << advice_of(c);
}

TEST(CalibrateFaults, BlurredImagesAreNotGood) {
  RandomStream random(20, "noise");
  BoardObservations observed = observe(simulated_boards(15, false, 640), random);
  for (auto& view : observed.views) view.relative_edge_width = 0.2;
  EXPECT_EQ(calibrate(observed).details["verdict"], "GOOD");
  for (auto& view : observed.views) view.relative_edge_width = 0.4;
  const RgbdCalibration c = calibrate(observed);
  EXPECT_EQ(c.details["verdict"], "WEAK");
  EXPECT_NE(advice_of(c).find("edges are as wide as 40 % of a square"), std::string::npos);
}

/// A board of 9x5 corners looks the same after half a turn; the detector begins at either end.
TEST(CalibrateFaults, TurnsViewsOfASymmetricBoardTheSameWay) {
  RandomStream random(19, "noise");
  BoardObservations observed = observe(simulated_boards(10, false), random);
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
  RandomStream random(18, "noise");
  BoardObservations observed = observe(boards, random);
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

}  // namespace
}  // namespace touchtrace
