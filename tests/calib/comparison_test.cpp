#include "calib/rgbd/comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

RgbdCalibration calibrated(const SimulatedBoards& boards, std::uint64_t seed) {
  RandomStream random(seed, "comparison");
  return calibrate(observe(boards, random), {.lenses = {"radtan4"}});
}

/// A mean square over the image is chi^2 with few degrees of freedom. With one, the largest spread,
/// its standard deviation is sqrt(2), and the mean over `pairs` deviates by at most 4 sqrt(2 /
/// pairs).
TEST(Comparison, StandardDeviationsExplainTwoSessionsOfOneCamera) {
  constexpr int pairs = 40;
  const SimulatedBoards boards = simulated_boards(15, false, 640);
  double mean_square = 0.0;
  int agree = 0;
  for (std::uint64_t pair = 0; pair < pairs; ++pair) {
    const auto difference = compare(calibrated(boards, 2 * pair), calibrated(boards, 2 * pair + 1));
    mean_square += difference.rms_sigmas() * difference.rms_sigmas() / pairs;
    agree += difference.agrees();
  }
  EXPECT_NEAR(mean_square, 1.0, 4.0 * std::sqrt(2.0 / pairs));
  EXPECT_GE(agree, pairs - 4);  // at one degree of freedom 5 % are over 2: 2 of 40, and 1.4 sigma
}

TEST(Comparison, ARotationOfTheCameraDoesNotCount) {
  const auto a = calibrated(simulated_boards(15, false, 640), 1);
  const auto difference = compare(a, a);
  EXPECT_LT(difference.worst_px(), 1e-6);
  auto moved = a;
  moved.color.cx += 3.0;  // nearly a rotation: what is left is far below 3 px in the median
  EXPECT_LT(compare(a, moved).median_px(), 0.5);
}

TEST(Comparison, AChangedFocusIsFound) {
  const auto a = calibrated(simulated_boards(15, false, 640), 1);
  auto b = a;
  b.color.fx *= 1.01, b.color.fy *= 1.01;
  const auto difference = compare(a, b);
  EXPECT_FALSE(difference.agrees());
  // 1 % of the distance from the centre, at most in a corner: half of the diagonal of 800 px.
  EXPECT_NEAR(difference.worst_px(), 4.0, 1.0);
}

TEST(Comparison, ADifferenceInOneCornerCounts) {
  CalibrationDifference difference{Eigen::MatrixXd::Zero(10, 10), Eigen::MatrixXd::Ones(10, 10)};
  difference.shift_px(0, 9) = 4.0;
  EXPECT_TRUE(difference.agrees());
  difference.shift_px(0, 9) = 6.0;
  EXPECT_LT(difference.rms_sigmas(), 1.0);
  EXPECT_FALSE(difference.agrees());
}

TEST(Comparison, AnotherImageSizeIsAnError) {
  const auto a = calibrated(simulated_boards(15, false, 640), 1);
  auto b = a;
  b.color.width = 320;
  EXPECT_THROW(compare(a, b), Error);
}

}  // namespace
}  // namespace touchtrace
