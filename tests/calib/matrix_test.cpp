// Products and decompositions against their definitions.
#include <gtest/gtest.h>

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double rounding = 1e-11;

MatrixXd random_matrix(Index rows, Index columns) {
  RandomStream random(1, "matrix");
  MatrixXd result(rows, columns);
  for (double& value : result.reshaped()) value = random.normal();
  return result;
}

/// Positive definite, with variances from 1e-12 to 1.
MatrixXd covariance(Index size) {
  const MatrixXd root = VectorXd::LinSpaced(size, -6.0, 0.0).array().exp().matrix().asDiagonal() *
                        random_matrix(size, 2 * size);
  return product(root, root.transpose());
}

TEST(Matrix, ProductsOfAnyLayout) {
  const MatrixXd a = random_matrix(3, 5), b = random_matrix(4, 5);
  const MatrixXd expected = a.lazyProduct(b.transpose());
  EXPECT_TRUE(product(a, b.transpose()).isApprox(expected));
  EXPECT_TRUE(congruence(b, covariance(5)).isApprox(b * covariance(5) * b.transpose()));
  EXPECT_EQ(product(MatrixXd(2, 0), MatrixXd(0, 3)), MatrixXd::Zero(2, 3));
}

TEST(Matrix, CholeskyOfACovariance) {
  const MatrixXd a = covariance(6), b = random_matrix(6, 2);
  const Cholesky cholesky(a);
  ASSERT_TRUE(cholesky.is_valid());
  const MatrixXd lower = cholesky.lower();
  EXPECT_TRUE(lower.isLowerTriangular());
  EXPECT_TRUE((lower * lower.transpose()).isApprox(a, rounding));
  EXPECT_TRUE((a * cholesky.solve(b)).isApprox(b, 1e-8));
  EXPECT_TRUE((lower * cholesky.solve_lower(b)).isApprox(b, rounding));
  EXPECT_TRUE((lower.transpose() * cholesky.solve_upper(b)).isApprox(b, rounding));
  EXPECT_TRUE(cholesky.inverse_corner(2).isApprox(a.inverse().topLeftCorner(2, 2), 1e-8));
  EXPECT_NEAR(cholesky.log_determinant(), std::log(a.determinant()), rounding);
}

TEST(Matrix, CholeskyRejectsWhatIsNotPositiveDefinite) {
  EXPECT_FALSE(Cholesky(MatrixXd()).is_valid());
  EXPECT_FALSE(Cholesky(MatrixXd::Zero(2, 2)).is_valid());
  EXPECT_FALSE(Cholesky(-MatrixXd::Identity(2, 2)).is_valid());
  EXPECT_FALSE(Cholesky(MatrixXd::Constant(2, 2, std::nan(""))).is_valid());
}

TEST(Matrix, SchurComplementIsTheInverseOfTheMarginalCovariance) {
  const MatrixXd information = random_matrix(6, 6) * random_matrix(6, 6).transpose();
  EXPECT_TRUE(schur_complement(information, 2)
                  .isApprox(information.inverse().topLeftCorner(2, 2).inverse(), 1e-8));
  EXPECT_EQ(schur_complement(MatrixXd::Zero(3, 3), 1).size(), 0);
}

TEST(Matrix, SemidefiniteSystemsHaveASolution) {
  const MatrixXd root = random_matrix(4, 2), a = root * root.transpose(),
                 b = a * random_matrix(4, 1);
  EXPECT_TRUE((a * solve_semidefinite(a, b)).isApprox(b, 1e-8));
}

TEST(Matrix, LeastSquaresKnowsTheRank) {
  const MatrixXd a = random_matrix(8, 3), b = random_matrix(8, 2);
  const LeastSquares fit = least_squares(a, b);
  EXPECT_EQ(fit.rank, 3);
  EXPECT_LT((a.transpose() * (a * fit.x - b)).norm(), rounding);
  EXPECT_EQ(least_squares(MatrixXd::Zero(4, 2), MatrixXd::Zero(4, 1)).rank, 0);
}

TEST(Matrix, SymmetricEigenvaluesCanBeReplaced) {
  const MatrixXd a = covariance(4);
  const SymmetricEigen eigen(a);
  EXPECT_TRUE(eigen.with_values(eigen.values).isApprox(a, rounding));
  EXPECT_TRUE(eigen.with_values(VectorXd::Ones(4)).isApprox(MatrixXd::Identity(4, 4), rounding));
}

}  // namespace
}  // namespace touchtrace
