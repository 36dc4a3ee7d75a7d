#include "calib/rgbd/view_covariance.h"

#include <algorithm>
#include <cmath>

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"
#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/normal_equations.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr Index min_views_for_scatter = 4;
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
  const Cholesky cholesky(reduced.parameters);
  if (!cholesky.is_valid()) return {};
  const VectorXd step = cholesky.solve(reduced.gradient);
  return {product(left_rotations, -step.head(size)),
          congruence(left_rotations, cholesky.inverse_corner(size))};
}

MatrixXd inverse_root(const MatrixXd& symmetric) {
  const SymmetricEigen eigen(symmetric);
  return eigen.with_values(eigen.values.cwiseSqrt().cwiseInverse());
}

/// Variance of the mean of each row.
VectorXd variances_of_means(const MatrixXd& values) {
  const auto n = static_cast<double>(values.cols());
  return (values.colwise() - values.rowwise().mean()).rowwise().squaredNorm() / (n * (n - 1.0));
}

/// Eigenvalues raised to at least 1.
MatrixXd at_least_identity(const MatrixXd& symmetric) {
  const SymmetricEigen eigen(symmetric);
  return eigen.with_values(eigen.values.cwiseMax(1.0));
}

/// Contributions [parameters, views], as shrunk_second_moment() takes them; empty if one cannot be
/// computed.
MatrixXd contributions_of_views(const Evaluation& evaluation, const MatrixXd& left_rotations) {
  const Index size = left_rotations.rows();
  const Linearized all = linearize(normal_equations(evaluation), left_rotations);
  const Cholesky cholesky(all.covariance);
  if (!cholesky.is_valid()) return {};
  MatrixXd columns(size, (evaluation.num_parameters() - size) / 6);
  for (Index view = 0; view < columns.cols(); ++view) {
    const Linearized others =
        linearize(normal_equations_without_view(evaluation, size + 6 * view), left_rotations);
    if (others.step.size() == 0) return {};
    const MatrixXd half = cholesky.solve_lower(others.covariance);
    const MatrixXd relative = cholesky.solve_lower(half.transpose());
    columns.col(view) = product(inverse_root(relative), cholesky.solve_lower(others.step));
  }
  return columns;
}

/// Roots of 1 / (1 - r), as shrunk_second_moment() describes r, of each parameter.
VectorXd factors_for_few_views(const MatrixXd& contributions, const std::vector<Index>& block_sizes,
                               double weight) {
  const double own = (1.0 - weight) * (1.0 - weight);
  VectorXd factors(contributions.rows());
  Index first = 0;
  for (const Index size : block_sizes) {
    const MatrixXd squares = static_cast<double>(contributions.cols()) *
                             contributions.middleRows(first, size).cwiseAbs2();
    const double relative_variance =
        (own * variances_of_means(squares).mean() +
         (1.0 - own) * variances_of_means(squares.colwise().mean()).value()) /
        std::pow(squares.mean(), 2);
    factors.segment(first, size)
        .setConstant(1.0 / std::sqrt(1.0 - std::min(relative_variance, max_relative_variance)));
    first += size;
  }
  return factors;
}

/// What a parameter belongs to: fx, fy, cx, cy of a camera; its other parameters; a pose; the
/// board.
std::string block_of(const std::string& parameter) {
  const std::size_t dot = parameter.rfind('.');
  const std::string name = parameter.substr(dot + 1);
  const bool is_core = name == "fx" || name == "fy" || name == "cx" || name == "cy";
  return parameter.substr(0, dot) + (is_core ? " core" : "");
}

/// Numbers of consecutive parameters of one block.
std::vector<Index> block_sizes(const std::vector<std::string>& parameters) {
  std::vector<Index> sizes;
  std::string last;
  for (const std::string& parameter : parameters) {
    const std::string block = block_of(parameter);
    if (block != last) sizes.push_back(0);
    ++sizes.back(), last = block;
  }
  return sizes;
}

/// Whether the views scatter by three standard errors more than with independent corners.
bool is_excessive(const MatrixXd& contributions) {
  const auto size = static_cast<double>(contributions.rows());
  const double freedom = size * static_cast<double>(contributions.cols());
  return contributions.squaredNorm() / size > 1.0 + 3.0 * std::sqrt(2.0 / freedom);
}

}  // namespace

MatrixXd shrunk_second_moment(const MatrixXd& contributions,
                              const std::vector<Index>& block_sizes) {
  const auto n = static_cast<double>(contributions.cols());
  const MatrixXd moment = product(contributions, contributions.transpose());
  VectorXd target(moment.rows());
  Index first = 0;
  for (const Index size : block_sizes) {
    target.segment(first, size).setConstant(moment.diagonal().segment(first, size).mean());
    first += size;
  }
  double spread = 0.0;
  for (const auto& column : contributions.colwise())
    spread += (n * column * column.transpose() - moment).squaredNorm() / (n * n);
  const MatrixXd diagonal = target.asDiagonal();
  const double distance = (moment - diagonal).squaredNorm();
  const double weight = distance > spread ? spread / distance : 1.0;
  const VectorXd factors = factors_for_few_views(contributions, block_sizes, weight);
  return factors.asDiagonal() * ((1.0 - weight) * moment + weight * diagonal) *
         factors.asDiagonal();
}

ViewCovariance view_covariance(const BoardProblem& problem, const RgbdParameters& parameters,
                               const MatrixXd& independent) {
  RgbdParameters p = parameters;
  const auto names = parameter_names(problem, p.lens);
  const auto evaluation = evaluate(*make_problem(problem, p), problem, p);
  if (!evaluation) return {independent, independent};
  return view_covariance(*evaluation, names,
                         left_rotation_jacobian(problem, p, static_cast<Index>(names.size())),
                         independent);
}

ViewCovariance view_covariance(const Evaluation& evaluation,
                               const std::vector<std::string>& parameters,
                               const MatrixXd& left_rotations, const MatrixXd& independent) {
  const MatrixXd columns = contributions_of_views(evaluation, left_rotations);
  const Cholesky cholesky(independent);
  if (columns.cols() < min_views_for_scatter || !cholesky.is_valid() || !is_excessive(columns))
    return {independent, independent};
  const MatrixXd relative =
      at_least_identity(shrunk_second_moment(columns, block_sizes(parameters)));
  if (!relative.allFinite()) return {independent, independent};
  return {independent, congruence(cholesky.lower(), relative),
          std::sqrt(relative.trace() / static_cast<double>(relative.rows()))};
}

}  // namespace touchtrace
