#include "calib/rgbd/board_problem.h"

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/rotation.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

/// Colour problem with weights such that all derivatives matter.
struct Example {
  SimulatedBoards boards = simulated_boards(6, false);
  BoardObservations observed;
  BoardProblem problem;
  RgbdParameters start;

  Example() : observed(noisy(boards)), problem{observed, std::vector<bool>(6, true), {}, {}} {
    problem.prior.color_sigma.fill(std::numeric_limits<double>::infinity());
    problem.prior.warp_sigma_m = 1e-3;
    problem.free_color = {0, 1, 2, 3, 4, 5, 6, 7};
    problem.corner_sigma_px = boards.corner_sigma_px;
    start = boards.truth;
    start.color[0] += 5.0, start.color[4] += 0.05;
    for (auto& pose : start.camera_from_board) pose[0] += 0.02, pose[5] += 0.01;
  }
  static BoardObservations noisy(const SimulatedBoards& boards) { return observe(boards, 1); }
};

TEST(BoardProblem, RotationsFollowTheEvaluationPoint) {
  Example example;
  const auto ceres_problem = make_problem(example.problem, example.start);
  for (const double angle : {0.1, -0.7}) {
    auto& pose = example.start.camera_from_board[2];
    pose[1] = angle;
    double cost = 0.0;
    ASSERT_TRUE(ceres_problem->problem.Evaluate({}, &cost, nullptr, nullptr, nullptr));
    EXPECT_EQ(ceres_problem->rotations[2].matrix, rotation_matrix({pose[0], pose[1], pose[2]}));
    EXPECT_EQ(ceres_problem->rotations[2].left_jacobian,
              left_jacobian({pose[0], pose[1], pose[2]}));
  }
}

TEST(BoardProblem, EvaluatesTheSameWithManyThreads) {
  Example example;
  const auto ceres_problem = make_problem(example.problem, example.start);
  for (int step = 0; step < 10; ++step) {
    for (auto& pose : example.start.camera_from_board) pose[0] += 1e-3;
    std::vector<double> residuals[2];
    ceres::CRSMatrix jacobians[2];
    for (int run = 0; run < 2; ++run) {
      ceres::Problem::EvaluateOptions options;
      options.num_threads = run == 0 ? 1 : 4;
      ASSERT_TRUE(ceres_problem->problem.Evaluate(options, nullptr, &residuals[run], nullptr,
                                                  &jacobians[run]));
    }
    EXPECT_EQ(residuals[0], residuals[1]) << step;
    EXPECT_EQ(jacobians[0].values, jacobians[1].values) << step;
  }
}

TEST(BoardProblem, SolutionDoesNotDependOnTheNumberOfThreads) {
  Example example;
  RgbdParameters one = example.start, four = example.start;
  ASSERT_TRUE(solve(example.problem, one));
  example.problem.num_threads = 4;
  ASSERT_TRUE(solve(example.problem, four));
  const Eigen::MatrixXd c = covariance(example.problem, one);
  // Threads only change the rounding of sums. Both solutions have a cost within 1e-10 of the
  // minimum cost, n / 2 for n coordinates: each is within sqrt(1e-10 n) standard deviations of the
  // minimum.
  const double sigmas =
      2.0 * std::sqrt(1e-10 * num_corner_coordinates(example.observed, example.problem.used));
  for (std::size_t i = 0; i < 8; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(one.color[i], four.color[i], sigmas * std::sqrt(c(at, at))) << i;
  }
}

}  // namespace
}  // namespace touchtrace
