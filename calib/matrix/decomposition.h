#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace touchtrace {

// Decompositions of matrices of any size. Their code is compiled once, here: in each file that
// decomposes a dynamic Eigen matrix it takes seconds.

/// Cholesky decomposition A = L L' of a symmetric matrix.
class Cholesky {
 public:
  explicit Cholesky(const Eigen::Ref<const Eigen::MatrixXd>& symmetric);

  /// False if A is empty or not positive definite.
  bool is_valid() const;
  /// A^-1 b.
  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const;
  /// L^-1 b.
  Eigen::MatrixXd solve_lower(const Eigen::Ref<const Eigen::MatrixXd>& b) const;
  /// L'^-1 b.
  Eigen::MatrixXd solve_upper(const Eigen::Ref<const Eigen::MatrixXd>& b) const;
  /// First `size` rows and columns of A^-1.
  Eigen::MatrixXd inverse_corner(Eigen::Index size) const;
  Eigen::MatrixXd lower() const;  ///< L
  double log_determinant() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> decomposition_;
};

/// Schur complement of all but the first `size` rows and columns of a symmetric matrix: the
/// information about `size` parameters when the others are marginalised out. Empty if the
/// information about the others is not positive definite.
Eigen::MatrixXd schur_complement(const Eigen::MatrixXd& symmetric, Eigen::Index size);

/// Solution of A x = b by LDL' with pivoting. A is symmetric and positive semidefinite.
Eigen::MatrixXd solve_semidefinite(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& b);

/// Minimum of |A x - b|, for each column of b.
struct LeastSquares {
  Eigen::MatrixXd x;
  Eigen::Index rank;  ///< of A
};

/// By QR with column pivoting.
LeastSquares least_squares(const Eigen::Ref<const Eigen::MatrixXd>& a,
                           const Eigen::Ref<const Eigen::MatrixXd>& b);

/// Eigenvalues, increasing, and eigenvectors of a symmetric matrix.
struct SymmetricEigen {
  explicit SymmetricEigen(const Eigen::Ref<const Eigen::MatrixXd>& symmetric);
  /// Matrix with the same eigenvectors and other eigenvalues.
  Eigen::MatrixXd with_values(const Eigen::VectorXd& other) const;

  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

}  // namespace touchtrace
