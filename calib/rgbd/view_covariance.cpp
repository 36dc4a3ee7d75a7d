#include "calib/rgbd/view_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/normal_equations.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr Index min_views_for_scatter = 6;
constexpr double max_relative_variance = 0.5;  ///< of a variance with four degrees of freedom

/// Gauss-Newton step and covariance of parameter_names(); empty if the equations are singular.
struct Linearized {
  VectorXd step;
  MatrixXd covariance;
};

/// `left_rotations`: left_rotation_jacobian().
Linearized linearize(const NormalEquations& equations, const MatrixXd& left_rotations) {
  const auto reduced = eliminate_offsets(equations);
  const Index size = left_rotations.rows();
  const MatrixXd marginal = marginal_covariance(reduced.parameters, size);
  if (marginal.size() == 0) return {};
  const VectorXd scale = reduced.parameters.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> cholesky(scale.asDiagonal() * reduced.parameters * scale.asDiagonal());
  const VectorXd step = scale.cwiseProduct(cholesky.solve(scale.cwiseProduct(reduced.gradient)));
  return {-left_rotations * step.head(size),
          left_rotations * marginal * left_rotations.transpose()};
}

MatrixXd inverse_root(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric).operatorInverseSqrt();
}

/// Variance of the mean of each row.
VectorXd variances_of_means(const MatrixXd& values) {
  const auto n = static_cast<double>(values.cols());
  return (values.colwise() - values.rowwise().mean()).rowwise().squaredNorm() / (n * (n - 1.0));
}

/// Eigenvalues raised to at least 1.
MatrixXd at_least_identity(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Contributions [parameters, views], as shrunk_second_moment() takes them; empty if one cannot be
/// computed.
MatrixXd contributions_of_views(const Evaluation& evaluation, const MatrixXd& left_rotations) {
  const Index size = left_rotations.rows();
  const Linearized all = linearize(normal_equations(evaluation), left_rotations);
  const Eigen::LLT<MatrixXd> root(all.covariance);
  if (all.step.size() == 0 || root.info() != Eigen::Success) return {};
  MatrixXd columns(size, (evaluation.num_parameters() - size) / 6);
  for (Index view = 0; view < columns.cols(); ++view) {
    const Linearized others =
        linearize(normal_equations_without_view(evaluation, size + 6 * view), left_rotations);
    if (others.step.size() == 0) return {};
    const MatrixXd half = root.matrixL().solve(others.covariance);
    const MatrixXd relative = root.matrixL().solve(half.transpose());
    columns.col(view) = inverse_root(relative) * root.matrixL().solve(others.step);
  }
  return columns;
}

/// Whether the views scatter by three standard errors more than with independent corners.
bool is_excessive(const MatrixXd& contributions) {
  const auto size = static_cast<double>(contributions.rows());
  const double freedom = size * static_cast<double>(contributions.cols());
  return contributions.squaredNorm() / size > 1.0 + 3.0 * std::sqrt(2.0 / freedom);
}

}  // namespace

MatrixXd shrunk_second_moment(const MatrixXd& contributions) {
  const auto n = static_cast<double>(contributions.cols()),
             d = static_cast<double>(contributions.rows());
  const MatrixXd identity = MatrixXd::Identity(contributions.rows(), contributions.rows());
  const MatrixXd moment = contributions * contributions.transpose();
  const double mean_square = moment.trace() / d;
  double spread = 0.0;
  for (const auto& column : contributions.colwise())
    spread += (n * column * column.transpose() - moment).squaredNorm() / (n * n);
  const double distance = (moment - mean_square * identity).squaredNorm();
  const double weight = distance > spread ? spread / distance : 1.0;
  const double own = (1.0 - weight) * (1.0 - weight);
  const MatrixXd squares = n * contributions.cwiseAbs2();  // [parameters, views]
  const double relative_variance =
      (own * variances_of_means(squares).mean() +
       (1.0 - own) * variances_of_means(squares.colwise().mean()).value()) /
      (mean_square * mean_square);
  return ((1.0 - weight) * moment + weight * mean_square * identity) /
         (1.0 - std::min(relative_variance, max_relative_variance));
}

ViewCovariance view_covariance(const BoardProblem& problem, const RgbdParameters& parameters,
                               const MatrixXd& independent) {
  RgbdParameters p = parameters;
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  const auto evaluation = evaluate(*make_problem(problem, p), problem, p);
  if (!evaluation) return {independent, independent};
  return view_covariance(*evaluation, left_rotation_jacobian(problem, p, size), independent);
}

ViewCovariance view_covariance(const Evaluation& evaluation, const MatrixXd& left_rotations,
                               const MatrixXd& independent) {
  const MatrixXd columns = contributions_of_views(evaluation, left_rotations);
  const Eigen::LLT<MatrixXd> root(independent);
  if (columns.cols() < min_views_for_scatter || root.info() != Eigen::Success ||
      !is_excessive(columns))
    return {independent, independent};
  const MatrixXd relative = at_least_identity(shrunk_second_moment(columns));
  if (!relative.allFinite()) return {independent, independent};
  const MatrixXd lower = root.matrixL();
  return {independent, lower * relative * lower.transpose(),
          std::sqrt(relative.trace() / static_cast<double>(relative.rows()))};
}

}  // namespace touchtrace
