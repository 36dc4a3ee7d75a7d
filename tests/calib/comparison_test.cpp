#include "calib/rgbd/comparison.h"

#include <gtest/gtest.h>

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

RgbdCalibration calibrated(const SimulatedBoards& boards, std::uint64_t seed) {
  RandomStream random(seed, "comparison");
  return calibrate(observe(boards, random), {.lenses = {"radtan4"}});
}

TEST(Comparison, TwoSessionsOfOneCameraAgree) {
  const SimulatedBoards boards = simulated_boards(15, false, 640);
  const auto difference = compare(calibrated(boards, 1), calibrated(boards, 2));
  EXPECT_TRUE(difference.agrees()) << difference.rms_sigmas();
  EXPECT_GT(difference.rms_sigmas(), 0.1);
  EXPECT_LT(difference.median_px(), difference.worst_px());
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

TEST(Comparison, AnotherImageSizeIsAnError) {
  const auto a = calibrated(simulated_boards(15, false, 640), 1);
  auto b = a;
  b.color.width = 320;
  EXPECT_THROW(compare(a, b), Error);
}

}  // namespace
}  // namespace touchtrace
