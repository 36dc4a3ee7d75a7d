#include "calib/rgbd/target_deformation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/cross_validation.h"
#include "tests/calib/calibration_checks.h"

namespace touchtrace {
namespace {

constexpr double deformation_sigma_m = 1e-4;

SimulatedBoards deformed_boards(int views, double corner_sigma_px, bool with_depth = false) {
  RandomStream random(1, "print");
  SimulatedBoards boards = with_deformed_target(
      simulated_boards(views, with_depth, with_depth ? 320 : 640), deformation_sigma_m, random);
  boards.corner_sigma_px = corner_sigma_px;
  return boards;
}

std::string chosen(const RgbdCalibration& c) { return c.details["target_deformation"]["chosen"]; }

Eigen::Matrix3Xd corners_of(const CalibrationTarget& board, const RgbdParameters& p) {
  Eigen::Matrix3Xd corners(3, board.num_corners());
  for (int i = 0; i < board.num_corners(); ++i) corners.col(i) = deformed_corner_m(board, i, p);
  return corners;
}

/// RMS [m] over the corners in each direction, after aligning pose and scale, which are not
/// observable.
Eigen::Vector3d shape_error(const CalibrationTarget& board, const RgbdParameters& estimate,
                            const RgbdParameters& truth) {
  const Eigen::Matrix3Xd from = corners_of(board, estimate), to = corners_of(board, truth);
  const Eigen::Matrix4d similarity = Eigen::umeyama(from, to);
  const Eigen::Matrix3Xd error = (similarity * from.colwise().homogeneous()).topRows<3>() - to;
  return error.rowwise().squaredNorm().cwiseSqrt() / std::sqrt(board.num_corners());
}

TEST(TargetDeformation, IsEstimated) {
  const SimulatedBoards boards = deformed_boards(15, 0.05);
  const RgbdCalibration c = calibrate(observe(boards, 2));
  ASSERT_EQ(chosen(c), "free");
  // Estimated from 3 x 54 offsets less 7 of pose and scale: 155 degrees of freedom; 4 sigma.
  EXPECT_NEAR(c.details["target_deformation"]["sigma_m"].get<double>(), deformation_sigma_m,
              4.0 * deformation_sigma_m / std::sqrt(2.0 * 155.0));
  // 0.05 px at 0.6 m and f = 610 px is 0.05 mm, 0.013 mm over 15 views; twice that along z, which
  // is seen through tilts of about 30 degrees. The RMS of 54 errors is below 1.4 times that.
  const Eigen::Vector3d error_m =
      shape_error(boards.clean.board, board_parameters(c), boards.truth);
  EXPECT_LT(error_m.x(), 0.018e-3);
  EXPECT_LT(error_m.y(), 0.018e-3);
  EXPECT_LT(error_m.z(), 0.036e-3);
  testing::expect_within_own_sigma(c, boards.truth);
}

TEST(TargetDeformation, IsNotEstimatedForAnIdealBoard) {
  for (int views : {3, 6, 15})
    for (std::uint64_t run = 0; run < 30; ++run) {
      const BoardObservations o = observe(simulated_boards(views, false), run);
      const RgbdCalibration c = calibrate(o, {.lenses = {"radtan4"}});
      EXPECT_EQ(chosen(c), "ideal")
          << views << " views: " << c.details["target_deformation"].dump();
      EXPECT_TRUE(c.details["target_deformation"]["offsets_m"].empty());
    }
}

TEST(TargetDeformation, CameraIsConsistentAndReachesTheCramerRaoBound) {
  const MonteCarlo result = monte_carlo(deformed_boards(15, 0.1), 60);
  EXPECT_EQ(result.num_free_deformations, result.runs);
  testing::expect_consistent(result.color_nees, 8, result.runs);
  testing::expect_efficient(result);
}

TEST(TargetDeformation, HeldOutViewsFitBetterThanWithTheIdealBoard) {
  const SimulatedBoards boards = deformed_boards(15, 0.05);
  const BoardObservations o = observe(boards, 3);
  const ColorFit fit = fit_color(o, std::vector<bool>(o.views.size(), true), {"radtan4"});
  BoardProblem problem = color_problem(o, fit);
  RgbdParameters parameters = fit.parameters;
  const HeldOut ideal = cross_validate(problem, parameters);
  fit_target_deformation(problem, parameters);
  // 0.1 mm at 0.6 m is 0.1 px: the error falls from sqrt(0.05^2 + 0.1^2) to 0.05 px.
  const HeldOut deformed = cross_validate(problem, parameters);
  EXPECT_LT(deformed.held_out_rms_px, 0.6 * ideal.held_out_rms_px);
  EXPECT_GT(deformed.ratio(), 1.0);  // the offsets come from the training views
}

/// Corners off their grid by a quarter of a square change fx by 1 % and more.
TEST(TargetDeformation, ABoardThatIsNotFlatIsNotGood) {
  const auto calibrated = [](double sigma_m) {
    RandomStream print(7, "print"), noise(8, "noise");
    return calibrate(
        observe(with_deformed_target(simulated_boards(15, false, 640), sigma_m, print), noise));
  };
  const auto advice = [](const RgbdCalibration& c) { return c.details["advice"].dump(); };
  const RgbdCalibration printed = calibrated(deformation_sigma_m), crumpled = calibrated(0.006);
  EXPECT_EQ(advice(printed), "[]");
  EXPECT_NE(crumpled.details["verdict"], "GOOD");
  EXPECT_NE(advice(crumpled).find("the board is not flat: fx changes by"), std::string::npos)
      << advice(crumpled) << crumpled.details["board_models"];
}

/// Each view shows a part of the board, as with ChArUco.
TEST(TargetDeformation, IsEstimatedFromPartialViews) {
  constexpr int never = 20, once = 33;
  const SimulatedBoards boards = deformed_boards(20, 0.05);
  RandomStream random(4, "noise");
  BoardObservations o = observe(boards, random);
  for (auto& view : o.views) {
    const auto all = view.corners_px;
    view.corners_px.clear();
    for (int i = 0; i < o.board.num_corners(); ++i)
      if (i != never && (i != once || &view == &o.views[0]) && random.uniform(0.0, 1.0) < 0.6)
        view.corners_px.push_back(all[std::size_t(i)]), view.corner_ids.push_back(i);
  }
  const RgbdCalibration c = calibrate(o, {.lenses = {"radtan4"}});
  ASSERT_EQ(chosen(c), "free");
  EXPECT_TRUE(board_parameters(c).corner_offsets_m[never].isZero(1e-12));
  testing::expect_within_own_sigma(c, boards.truth);
}

TEST(TargetDeformation, IsEstimatedWithADepthCamera) {
  const SimulatedBoards boards = deformed_boards(15, 0.05, true);
  const RgbdCalibration c = calibrate(observe(boards, 5));
  EXPECT_EQ(chosen(c), "free");
  testing::expect_within_own_sigma(c, boards.truth);
}

/// Pose and scale of the board are not observable: the prior keeps them.
TEST(TargetDeformation, KeepsTheBoardsPoseAndSize) {
  const SimulatedBoards boards = deformed_boards(15, 0.05);
  const RgbdParameters found = board_parameters(calibrate(observe(boards, 6)));
  ASSERT_FALSE(found.corner_offsets_m.empty());
  const Eigen::Matrix3Xd ideal = corners_of(boards.clean.board, {});
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  double growth = 0.0;
  for (int i = 0; i < boards.clean.board.num_corners(); ++i) {
    const Eigen::Vector3d& offset_m = found.corner_offsets_m[std::size_t(i)];
    mean_m += offset_m / boards.clean.board.num_corners();
    growth += offset_m.dot(ideal.col(i) - ideal.rowwise().mean()) / ideal.squaredNorm();
  }
  EXPECT_LT(mean_m.norm(), 1e-3 * deformation_sigma_m);
  EXPECT_LT(std::abs(growth), 1e-5);
}

TEST(BoardModels, FlatBoardAndIdealCornersCanBeDemanded) {
  RandomStream random(31, "noise");
  const SimulatedBoards warped = with_deformed_target(
      with_warp(simulated_boards(15, false, 640), {1e-3, 0.5e-3}), 2e-4, random);
  const BoardObservations observed = observe(warped, random);
  const RgbdCalibration all = calibrate(observed, {.lenses = {"radtan4"}});
  BoardObservations of_flat_board = observed;
  of_flat_board.board.is_flat = true;
  const RgbdCalibration flat =
      calibrate(of_flat_board, {.lenses = {"radtan4"}, .target_deformation = false});
  EXPECT_EQ(all.details["target_deformation"]["chosen"], "free");
  EXPECT_EQ(flat.details["target_deformation"]["chosen"], "ideal");
  EXPECT_LT(std::abs(flat.board_warp_m[0]), 1e-6);
  EXPECT_EQ(flat.details["not_identifiable"].dump().find("board."), std::string::npos);
  EXPECT_TRUE(flat.details["board_models"]["warped"].is_null());
  // The prediction is linear: within a fifth of the change.
  const double predicted_px = all.details["board_models"]["flat"][0];
  const double change_px =
      std::abs(flat.color.fx - all.details["board_models"]["warped"][0].get<double>());
  EXPECT_GT(change_px, 0.5);
  EXPECT_NEAR(predicted_px, flat.color.fx, 0.2 * change_px);
}

}  // namespace
}  // namespace touchtrace
