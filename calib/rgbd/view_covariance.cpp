#include "calib/rgbd/view_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>

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

Linearized linearize(const BoardProblem& problem, RgbdParameters p) {
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  const auto ceres_problem = make_problem(problem, p);
  const auto equations = eliminate_offsets(normal_equations(*ceres_problem, problem, p));
  const MatrixXd marginal = marginal_covariance(equations.parameters, size);
  if (marginal.size() == 0) return {};
  const VectorXd scale = equations.parameters.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> cholesky(scale.asDiagonal() * equations.parameters *
                                      scale.asDiagonal());
  const VectorXd step = scale.cwiseProduct(cholesky.solve(scale.cwiseProduct(equations.gradient)));
  const MatrixXd jacobian = left_rotation_jacobian(problem, p, size);
  return {-jacobian * step.head(size), jacobian * marginal * jacobian.transpose()};
}

BoardProblem without_view(const BoardProblem& problem, std::size_t view) {
  BoardProblem others = problem;
  others.used[view] = false;
  std::erase_if(others.samples, [&](const DepthSample& sample) { return sample.view == view; });
  return others;
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

Contributions contributions_of_views(const BoardProblem& problem, const RgbdParameters& parameters) {
  const Linearized all = linearize(problem, parameters);
  const Eigen::LLT<MatrixXd> root(all.covariance);
  if (all.step.size() == 0 || root.info() != Eigen::Success) return {};
  const auto views = used_views(problem);
  const Index size = all.step.size();
  Contributions result{MatrixXd(size, static_cast<Index>(views.size()))};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Linearized others = linearize(without_view(problem, views[i]), parameters);
    if (others.step.size() == 0) return {};
    const MatrixXd half = root.matrixL().solve(others.covariance);
    const MatrixXd relative = root.matrixL().solve(half.transpose());
    result.columns.col(static_cast<Index>(i)) =
        power(relative, -0.5) * root.matrixL().solve(others.step);
    result.dimensions += static_cast<double>(size) - power(relative, -1.0).trace();
  }
  return result;
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
  const auto [columns, dimensions] = contributions_of_views(problem, parameters);
  const Eigen::LLT<MatrixXd> root(independent);
  if (columns.cols() < 2 || !columns.allFinite() || root.info() != Eigen::Success)
    return {independent};
  const auto size = static_cast<double>(columns.rows());
  const MatrixXd relative = shrunk_second_moment(columns, std::clamp(dimensions, 1.0, size));
  if (!relative.allFinite()) return {independent};
  const MatrixXd lower = root.matrixL();
  return {lower * relative * lower.transpose(), std::sqrt(relative.trace() / size)};
}

}  // namespace touchtrace
