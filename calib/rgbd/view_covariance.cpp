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

MatrixXd power(const MatrixXd& symmetric, double exponent) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
  return eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).array().pow(exponent).matrix().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Contributions of the views and the number of dimensions that they determine, as
/// shrunk_second_moment() takes them.
struct Contributions {
  MatrixXd columns;
  double dimensions = 0.0;
};

Contributions contributions_of_views(const BoardProblem& problem, RgbdParameters p) {
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  const MatrixXd left_rotations = left_rotation_jacobian(problem, p, size);
  const auto ceres_problem = make_problem(problem, p);
  const auto evaluation = evaluate(*ceres_problem, problem, p);
  if (!evaluation) return {};
  const Linearized all = linearize(normal_equations(*evaluation), left_rotations);
  const Eigen::LLT<MatrixXd> root(all.covariance);
  if (all.step.size() == 0 || root.info() != Eigen::Success) return {};
  const auto count = static_cast<Index>(used_views(problem).size());
  Contributions result{MatrixXd(size, count)};
  for (Index view = 0; view < count; ++view) {
    const Linearized others =
        linearize(normal_equations_without_view(*evaluation, size + 6 * view), left_rotations);
    if (others.step.size() == 0) return {};
    const MatrixXd half = root.matrixL().solve(others.covariance);
    const MatrixXd relative = root.matrixL().solve(half.transpose());
    result.columns.col(view) = power(relative, -0.5) * root.matrixL().solve(others.step);
    result.dimensions += static_cast<double>(size) - power(relative, -1.0).trace();
  }
  result.dimensions = std::clamp(result.dimensions, 1.0, static_cast<double>(size));
  return result;
}

/// Whether the views scatter by three standard errors more than with independent corners.
bool is_excessive(const Contributions& views) {
  const double mean_square = views.columns.squaredNorm() / views.dimensions;
  const double freedom = views.dimensions * static_cast<double>(views.columns.cols());
  return mean_square > 1.0 + 3.0 * std::sqrt(2.0 / freedom);
}

}  // namespace

MatrixXd shrunk_second_moment(const MatrixXd& contributions, double dimensions) {
  const auto n = static_cast<double>(contributions.cols());
  const MatrixXd identity = MatrixXd::Identity(contributions.rows(), contributions.rows());
  const MatrixXd moment = contributions * contributions.transpose();
  const double mean_square = moment.trace() / dimensions;
  double spread = 0.0, variance = 0.0;
  for (const auto& column : contributions.colwise()) {
    spread += (n * column * column.transpose() - moment).squaredNorm() / (n * n);
    variance += std::pow(n * column.squaredNorm() / dimensions - mean_square, 2) / (n * (n - 1.0));
  }
  const double distance = (moment - mean_square * identity).squaredNorm();
  const double weight = distance > spread ? spread / distance : 1.0;
  return (1.0 + variance / (mean_square * mean_square)) *
         ((1.0 - weight) * moment + weight * mean_square * identity);
}

ViewCovariance view_covariance(const BoardProblem& problem, const RgbdParameters& parameters,
                               const MatrixXd& independent) {
  const Contributions views = contributions_of_views(problem, parameters);
  const Eigen::LLT<MatrixXd> root(independent);
  if (views.columns.cols() < 2 || root.info() != Eigen::Success || !is_excessive(views))
    return {independent};
  const MatrixXd relative = shrunk_second_moment(views.columns, views.dimensions);
  if (!relative.allFinite()) return {independent};
  const MatrixXd lower = root.matrixL();
  return {lower * relative * lower.transpose(),
          std::sqrt(relative.trace() / static_cast<double>(relative.rows()))};
}

}  // namespace touchtrace
