#include "calib/rgbd/board_print.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/cross_validation.h"
#include "tests/verify/calib/monte_carlo.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

constexpr double print_sigma_m = 1e-4;

SimulatedBoards badly_printed(int views, double corner_sigma_px, bool with_depth = false) {
  RandomStream random(1, "print");
  SimulatedBoards boards = misprinted(simulated_boards(views, with_depth, with_depth ? 320 : 640),
                                      print_sigma_m, random);
  boards.corner_sigma_px = corner_sigma_px;
  return boards;
}

std::string chosen(const RgbdCalibration& c) { return c.details["board_print"]["chosen"]; }

Eigen::Matrix3Xd corners_of(const Chessboard& board, const RgbdParameters& p) {
  Eigen::Matrix3Xd corners(3, board.corners());
  for (int i = 0; i < board.corners(); ++i) corners.col(i) = corner_on_board(board, i, p);
  return corners;
}

/// RMS [m] in each direction, over `corners`, of the board's shape: no view tells its place and
/// size.
Eigen::Vector3d shape_error(const Chessboard& board, const RgbdParameters& estimate,
                            const RgbdParameters& truth) {
  const Eigen::Matrix3Xd from = corners_of(board, estimate), to = corners_of(board, truth);
  const Eigen::Matrix4d similarity = Eigen::umeyama(from, to);
  const Eigen::Matrix3Xd error = (similarity * from.colwise().homogeneous()).topRows<3>() - to;
  return error.rowwise().squaredNorm().cwiseSqrt() / std::sqrt(board.corners());
}

void expect_true_within_its_covariance(const RgbdCalibration& c, const RgbdParameters& truth) {
  const Eigen::VectorXd error = errors(c, truth);
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 4.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

TEST(BoardPrint, IsFound) {
  const SimulatedBoards boards = badly_printed(15, 0.05);
  RandomStream random(2, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  ASSERT_EQ(chosen(c), "free");
  // A deviation from 155 numbers, within four of its own.
  EXPECT_NEAR(c.details["board_print"]["sigma_m"].get<double>(), print_sigma_m,
              4.0 * print_sigma_m / std::sqrt(2.0 * 155.0));
  // 0.05 px at 0.6 m through 610 px is 0.05 mm, over 15 views 0.013 mm; along z, which views tilted
  // by some 30 degrees show, twice that. An RMS of 54 such errors is within 1.4 times of it.
  const Eigen::Vector3d error_m = shape_error(boards.clean.board, board_of(c), boards.truth);
  EXPECT_LT(error_m.x(), 0.018e-3);
  EXPECT_LT(error_m.y(), 0.018e-3);
  EXPECT_LT(error_m.z(), 0.036e-3);
  expect_true_within_its_covariance(c, boards.truth);
}

TEST(BoardPrint, IsNotFoundWhereThereIsNone) {
  for (int views : {3, 6, 15})
    for (std::uint64_t run = 0; run < 30; ++run) {
      RandomStream random(run, "noise");
      const BoardObservations o = observe(simulated_boards(views, false), random);
      const RgbdCalibration c = calibrate(o, {.lenses = {"radtan4"}});
      EXPECT_EQ(chosen(c), "ideal") << views << " views: " << c.details["board_print"].dump();
      EXPECT_TRUE(c.details["board_print"]["offsets_m"].empty());
    }
}

TEST(BoardPrint, CameraReachesTheCramerRaoBoundWithATrueCovariance) {
  const MonteCarlo result = monte_carlo(badly_printed(15, 0.1), 60);
  EXPECT_EQ(result.free_prints, result.runs);
  // As in calibrate_test: chi^2 with 8 degrees of freedom, and RMSE of `runs` draws.
  EXPECT_NEAR(result.color_nees, 1.0, 4.0 * std::sqrt(2.0 / (8.0 * result.runs)));
  for (std::size_t i = 0; i < result.names.size(); ++i)
    EXPECT_NEAR(result.rmse_ratio[i], 1.0, 4.0 / std::sqrt(2.0 * result.runs)) << result.names[i];
}

TEST(BoardPrint, HeldOutViewsFitBetterThanWithTheIdealBoard) {
  const SimulatedBoards boards = badly_printed(15, 0.05);
  RandomStream random(3, "noise");
  const BoardObservations o = observe(boards, random);
  const ColorFit fit = fit_color(o, std::vector<bool>(o.views.size(), true), {"radtan4"});
  BoardProblem problem = color_problem(o, fit);
  RgbdParameters parameters = fit.parameters;
  const HeldOut ideal = cross_validate(problem, parameters);
  choose_print(problem, parameters);
  // 0.1 mm at 0.6 m are 0.1 px, which are no longer there: sqrt(0.05^2 + 0.1^2) -> 0.05 px.
  const HeldOut printed = cross_validate(problem, parameters);
  EXPECT_LT(printed.held_out_rms_px, 0.6 * ideal.held_out_rms_px);
  EXPECT_GT(printed.ratio(), 1.0);  // the offsets are those of the training views
}

/// A ChArUco board of which each view shows a part.
TEST(BoardPrint, IsFoundInPartsOfABoard) {
  constexpr int never = 20, once = 33;
  const SimulatedBoards boards = badly_printed(20, 0.05);
  RandomStream random(4, "noise");
  BoardObservations o = observe(boards, random);
  for (auto& view : o.views) {
    const auto all = view.corners_px;
    view.corners_px.clear();
    for (int i = 0; i < o.board.corners(); ++i)
      if (i != never && (i != once || &view == &o.views[0]) && random.uniform(0.0, 1.0) < 0.6)
        view.corners_px.push_back(all[std::size_t(i)]), view.shown.push_back(i);
  }
  const RgbdCalibration c = calibrate(o, {.lenses = {"radtan4"}});
  ASSERT_EQ(chosen(c), "free");
  EXPECT_TRUE(board_of(c).board_offsets_m[never].isZero(1e-12));
  expect_true_within_its_covariance(c, boards.truth);
}

TEST(BoardPrint, IsFoundWithADepthCamera) {
  const SimulatedBoards boards = badly_printed(15, 0.05, true);
  RandomStream random(5, "noise");
  const RgbdCalibration c = calibrate(observe(boards, random));
  EXPECT_EQ(chosen(c), "free");
  expect_true_within_its_covariance(c, boards.truth);
}

/// No view tells where the middle of the board is and how large it is: it stays what it was said to
/// be.
TEST(BoardPrint, LeavesTheBoardsPlaceAndSize) {
  const SimulatedBoards boards = badly_printed(15, 0.05);
  RandomStream random(6, "noise");
  const RgbdParameters found = board_of(calibrate(observe(boards, random)));
  ASSERT_FALSE(found.board_offsets_m.empty());
  const Eigen::Matrix3Xd ideal = corners_of(boards.clean.board, {});
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  double growth = 0.0;
  for (int i = 0; i < boards.clean.board.corners(); ++i) {
    const Eigen::Vector3d& offset_m = found.board_offsets_m[std::size_t(i)];
    mean_m += offset_m / boards.clean.board.corners();
    growth += offset_m.dot(ideal.col(i) - ideal.rowwise().mean()) / ideal.squaredNorm();
  }
  EXPECT_LT(mean_m.norm(), 1e-3 * print_sigma_m);
  EXPECT_LT(std::abs(growth), 1e-5);
}

}  // namespace
}  // namespace touchtrace
