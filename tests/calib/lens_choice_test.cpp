#include <gtest/gtest.h>

#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

constexpr double deformation_sigma_m = 3e-4;

/// Views of a deformed board through a lens with radial distortion `k1`. The deformation moves
/// corners by 0.3 px, `k1` = 0.01 by 0.8 px at most, which the focal length partly compensates.
BoardObservations observe_deformed_board(double k1, std::uint64_t run) {
  RandomStream print(run, "print"), noise(run, "noise");
  SimulatedBoards boards = with_deformed_target(
      with_lens_coefficients(simulated_boards(15, false, 640), Radtan4{}, {k1}),
      deformation_sigma_m, print);
  boards.corner_sigma_px = 0.05;
  return observe(boards, noise);
}

std::string chosen_lens(double k1, std::uint64_t run, bool target_deformation) {
  return calibrate(observe_deformed_board(k1, run), {.target_deformation = target_deformation})
      .details["lens"];
}

TEST(LensChoice, DistortionThatADeformedBoardHidesIsFound) {
  for (std::uint64_t run = 0; run < 4; ++run) {
    EXPECT_EQ(chosen_lens(0.01, run, false), "none") << run;  // else the test shows nothing
    EXPECT_EQ(chosen_lens(0.01, run, true), "radtan4") << run;
  }
}

TEST(LensChoice, DeformationIsNotTakenForDistortion) {
  for (std::uint64_t run = 0; run < 4; ++run) EXPECT_EQ(chosen_lens(0.0, run, true), "none") << run;
}

TEST(LensChoice, ChoosesNoneWithoutRadialDistortion) {
  const SimulatedBoards boards = with_lens_coefficients(simulated_boards(15, false), Radtan4{}, {});
  EXPECT_EQ(calibrate(observe(boards, 3)).details["lens"], "none");
}

TEST(LensChoice, RemovesUnobservableCoefficients) {
  const SimulatedBoards boards = simulated_boards(12, false, 640);
  const RgbdCalibration c = calibrate(observe(boards, 12), {.lenses = {"rational8"}});
  const auto& removed = c.details["lenses"][0]["removed"];
  ASSERT_FALSE(removed.empty());
  EXPECT_EQ(removed[0]["parameter"], "k6");
  EXPECT_EQ(c.color.distortion[7], 0.0);
  EXPECT_NEAR(c.color.fx, boards.truth.color[0], 4.5 * std::sqrt(c.covariance(0, 0)));
}

}  // namespace
}  // namespace touchtrace
