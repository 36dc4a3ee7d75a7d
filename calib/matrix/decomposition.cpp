#include "calib/matrix/decomposition.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "calib/matrix/product.h"

namespace touchtrace {

using Eigen::Index, Eigen::MatrixXd, Eigen::Ref;

Cholesky::Cholesky(const Ref<const MatrixXd>& symmetric) : decomposition_(symmetric) {}

/// Eigen reports success for NaN.
bool Cholesky::is_valid() const {
  return decomposition_.rows() > 0 && decomposition_.info() == Eigen::Success &&
         decomposition_.matrixLLT().diagonal().allFinite();
}

MatrixXd Cholesky::solve(const Ref<const MatrixXd>& b) const { return solve_upper(solve_lower(b)); }

MatrixXd Cholesky::solve_lower(const Ref<const MatrixXd>& b) const {
  return decomposition_.matrixL().solve(b);
}

MatrixXd Cholesky::solve_upper(const Ref<const MatrixXd>& b) const {
  return decomposition_.matrixU().solve(b);
}

MatrixXd Cholesky::inverse_corner(Index size) const {
  return solve(MatrixXd::Identity(decomposition_.rows(), size)).topRows(size);
}

MatrixXd Cholesky::lower() const { return decomposition_.matrixL(); }

double Cholesky::log_determinant() const {
  return 2.0 * decomposition_.matrixLLT().diagonal().array().log().sum();
}

MatrixXd schur_complement(const MatrixXd& symmetric, Index size) {
  const Index rest = symmetric.rows() - size;
  const Cholesky cholesky(symmetric.bottomRightCorner(rest, rest));
  if (!cholesky.is_valid()) return {};
  const MatrixXd across = symmetric.bottomLeftCorner(rest, size);
  return symmetric.topLeftCorner(size, size) - product(across.transpose(), cholesky.solve(across));
}

MatrixXd solve_semidefinite(const Ref<const MatrixXd>& a, const Ref<const MatrixXd>& b) {
  return a.ldlt().solve(b);
}

LeastSquares least_squares(const Ref<const MatrixXd>& a, const Ref<const MatrixXd>& b) {
  const Eigen::ColPivHouseholderQR<MatrixXd> decomposition(a);
  return {decomposition.solve(b), decomposition.rank()};
}

SymmetricEigen::SymmetricEigen(const Ref<const MatrixXd>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  values = solver.eigenvalues(), vectors = solver.eigenvectors();
}

MatrixXd SymmetricEigen::with_values(const Eigen::VectorXd& other) const {
  return product(vectors * other.asDiagonal(), vectors.transpose());
}

}  // namespace touchtrace
