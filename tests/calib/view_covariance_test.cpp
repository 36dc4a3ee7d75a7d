#include "calib/rgbd/view_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "calib/rgbd/calibrate.h"
#include "tests/verify/calib/monte_carlo.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {
namespace {

constexpr int runs = 40;

/// Adds an error that all corners of a view share: a random quadratic function of the place on the
/// board, of `sigma_px` for each of its terms, as a board that bends differently in each view.
void bend(BoardObservations& observed, double sigma_px, RandomStream& random) {
  for (auto& view : observed.views) {
    Eigen::Matrix<double, 2, 3> factors;
    for (double& factor : factors.reshaped()) factor = sigma_px * random.normal();
    for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
      const int id = view.corner_id(i), columns = observed.board.columns;
      const double x = 2.0 * (id % columns) / (columns - 1) - 1.0,
                   y = 2.0 * (id / columns) / (observed.board.rows - 1) - 1.0;
      view.corners_px[i] += factors * Eigen::Vector3d(x * x, x * y, y * y);
    }
  }
}

/// Mean normalised squared error of fx, fy, cx, cy, and mean inflation.
std::pair<double, double> mean_nees(double bend_sigma_px) {
  const SimulatedBoards boards = simulated_boards(15, false);
  double nees = 0.0, inflation = 0.0;
  for (std::uint64_t run = 0; run < runs; ++run) {
    RandomStream random(run, "bent boards");
    BoardObservations observed = observe(boards, random);
    bend(observed, bend_sigma_px, random);
    const RgbdCalibration c = calibrate(observed, {.lenses = {"radtan4"}});
    const Eigen::Vector4d error = errors(c, boards.truth).head<4>();
    nees += error.dot(c.covariance.topLeftCorner<4, 4>().ldlt().solve(error)) / (4.0 * runs);
    inflation += c.details["view_inflation"].get<double>() / runs;
  }
  return {nees, inflation};
}

TEST(ViewCovariance, KeepsTheCovarianceOfIndependentCorners) {
  const auto [nees, inflation] = mean_nees(0.0);
  EXPECT_LT(inflation, 1.05);
  EXPECT_NEAR(nees, 1.0, 4.0 * std::sqrt(2.0 / (4 * runs)));
}

/// The covariance comes from 15 views, so that the squared error over it follows Hotelling's
/// distribution, of mean up to (15 - 1) / (15 - 1 - 4 - 1) = 1.56 without shrinkage.
TEST(ViewCovariance, CoversErrorsThatTheCornersOfAViewShare) {
  const auto [nees, inflation] = mean_nees(0.5);
  EXPECT_GT(inflation, 2.0);
  EXPECT_GT(nees, 1.0 - 4.0 * std::sqrt(2.0 / (4 * runs)));
  EXPECT_LT(nees, 1.56 + 4.0 * 1.56 * std::sqrt(2.0 / (4 * runs)));
}

TEST(ViewCovariance, SecondMomentOfManyViewsIsNotShrunk) {
  RandomStream random(1, "contributions");
  Eigen::Matrix2d truth;
  truth << 9.0, 3.0, 3.0, 5.0;
  const Eigen::Matrix2d root = truth.llt().matrixL();
  constexpr int views = 20000;
  Eigen::MatrixXd contributions(2, views);
  for (int i = 0; i < views; ++i)
    contributions.col(i) =
        root * Eigen::Vector2d(random.normal(), random.normal()) / std::sqrt(views);
  const Eigen::MatrixXd found = shrunk_second_moment(contributions, {2});
  // Relative standard error of a variance: sqrt(2 / views) = .01; 4 of these.
  EXPECT_TRUE(found.isApprox(truth, 0.04)) << found;
}

TEST(ViewCovariance, SecondMomentOfFewViewsIsNearlyAMultipleOfTheIdentity) {
  RandomStream random(2, "contributions");
  constexpr int views = 6, parameters = 10;
  Eigen::MatrixXd contributions(parameters, views);
  for (double& value : contributions.reshaped()) value = 3.0 * random.normal() / std::sqrt(views);
  const Eigen::VectorXd found = shrunk_second_moment(contributions, {parameters})
                                    .selfadjointView<Eigen::Lower>()
                                    .eigenvalues();
  // The plain second moment has rank 6. The mean of 60 squares has a relative standard error of
  // sqrt(2 / 60) = .18; 4 of these, and the factor of at most 1.2 for few views.
  EXPECT_GT(found.minCoeff(), 9.0 * (1.0 - 4.0 * 0.18) / 2.0);
  EXPECT_NEAR(found.mean(), 9.0 * 1.1, 9.0 * (4.0 * 0.18 + 0.1));
}

/// Two kinds of parameters whose errors are inflated 2 and 6 times.
TEST(ViewCovariance, FewViewsAreShrunkToTheMeanSquareOfEachBlock) {
  RandomStream random(3, "contributions");
  constexpr int views = 8, block = 50;
  Eigen::MatrixXd contributions(2 * block, views);
  for (double& value : contributions.reshaped()) value = random.normal() / std::sqrt(views);
  contributions.topRows(block) *= 2.0, contributions.bottomRows(block) *= 6.0;
  const Eigen::VectorXd found = shrunk_second_moment(contributions, {block, block}).diagonal();
  // 400 squares: relative standard error sqrt(2 / 400) = .07; 4 of these, and 1 / (1 - r) < 1.3.
  EXPECT_NEAR(found.head(block).mean(), 4.0 * 1.15, 4.0 * (0.28 + 0.15));
  EXPECT_NEAR(found.tail(block).mean(), 36.0 * 1.15, 36.0 * (0.28 + 0.15));
}

}  // namespace
}  // namespace touchtrace
