#include "calib/rgbd/normal_equations.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/matrix/product.h"
#include "calib/rgbd/ceres_problem.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Parameter blocks in the order of parameter_names(), then poses, then offsets.
std::vector<double*> parameter_blocks(const BoardProblem& problem, RgbdParameters& p) {
  std::vector<double*> blocks{p.color.data(), p.board_warp_m.data()};
  if (!problem.samples.empty())
    blocks.insert(blocks.end(),
                  {p.depth_from_color.data(), p.depth.data(), p.depth_correction.data()});
  if (!problem.samples.empty() && problem.free_delay) blocks.push_back(&p.depth_delay_s);
  for (std::size_t view : used_views(problem)) blocks.push_back(p.camera_from_board[view].data());
  if (has_free_deformation(problem))
    for (auto& offset_m : p.corner_offsets_m) blocks.push_back(offset_m.data());
  return blocks;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Consecutive rows that depend on the same parameters, such as the corners of a view. Columns of
/// an offset come last and differ between rows.
struct Rows {
  Eigen::Map<const RowMajor> jacobian;
  Eigen::Map<const VectorXd> residuals;
  const int* columns;  ///< column indices, row after row
  Index parameters;    ///< number of columns without those of an offset

  const int* column_indices(Index row) const { return columns + row * jacobian.cols(); }
};

Rows rows_from(const ceres::CRSMatrix& crs, const std::vector<double>& residuals, int first,
               Index parameters) {
  const auto begin = [&](int row) { return crs.cols.begin() + crs.rows[std::size_t(row)]; };
  const auto end = std::lower_bound(begin(first), begin(first + 1), parameters);
  const auto width = begin(first + 1) - begin(first);
  int last = first + 1;
  while (last < crs.num_rows && begin(last + 1) - begin(last) == width &&
         std::equal(begin(first), end, begin(last)))
    ++last;
  const auto at = std::size_t(crs.rows[std::size_t(first)]);
  return {{crs.values.data() + at, last - first, width},
          {residuals.data() + first, last - first},
          crs.cols.data() + at,
          end - begin(first)};
}

void add_parameters(const Rows& rows, NormalEquations& sum) {
  const auto part = rows.jacobian.leftCols(rows.parameters);
  const MatrixXd square = product(part.transpose(), part);
  const VectorXd slope = product(part.transpose(), rows.residuals);
  for (Index a = 0; a < rows.parameters; ++a) {
    sum.parameters_gradient[rows.columns[a]] += slope[a];
    for (Index b = 0; b < rows.parameters; ++b)
      sum.parameters(rows.columns[a], rows.columns[b]) += square(a, b);
  }
}

void add_offsets(const Rows& rows, NormalEquations& sum) {
  if (rows.parameters == rows.jacobian.cols()) return;
  for (Index row = 0; row < rows.jacobian.rows(); ++row) {
    const int* columns = rows.column_indices(row);
    const Index offset = columns[rows.parameters] - sum.parameters.rows();
    const Eigen::RowVector3d by_offset = rows.jacobian.row(row).tail<3>();
    sum.offsets_gradient.segment<3>(offset) += rows.residuals[row] * by_offset.transpose();
    sum.offsets.middleCols<3>(offset) += by_offset.transpose() * by_offset;
    for (Index a = 0; a < rows.parameters; ++a)
      sum.coupling.row(columns[a]).segment<3>(offset) += rows.jacobian(row, a) * by_offset;
  }
}

/// Sums over the rows for which `is_included`.
template <class Predicate>
NormalEquations sum_over_rows(const Evaluation& evaluation, const Predicate& is_included) {
  const auto& [crs, residuals, num_offsets] = evaluation;
  const Index first = evaluation.num_parameters();
  NormalEquations sum{MatrixXd::Zero(first, first),
                      MatrixXd::Zero(first, num_offsets),
                      Eigen::Matrix3Xd::Zero(3, num_offsets),
                      VectorXd::Zero(first),
                      VectorXd::Zero(num_offsets),
                      0.0};
  for (int row = 0; row < crs.num_rows;) {
    const Rows rows = rows_from(crs, residuals, row, first);
    row += static_cast<int>(rows.jacobian.rows());
    if (!is_included(rows)) continue;
    add_parameters(rows, sum), add_offsets(rows, sum);
    sum.squares += rows.residuals.squaredNorm();
  }
  return sum;
}

}  // namespace

std::optional<Evaluation> evaluate(CeresProblem& ceres_problem, const BoardProblem& problem,
                                   RgbdParameters& p) {
  const auto corners = static_cast<Index>(p.corner_offsets_m.size());
  return evaluate(ceres_problem.problem, parameter_blocks(problem, p),
                  has_free_deformation(problem) ? 3 * corners : 0, problem.num_threads);
}

std::optional<Evaluation> evaluate(ceres::Problem& problem, std::vector<double*> blocks,
                                   Index num_offsets, int num_threads) {
  ceres::Problem::EvaluateOptions options;
  options.num_threads = num_threads;
  options.parameter_blocks = std::move(blocks);
  Evaluation result;
  result.num_offsets = num_offsets;
  if (!problem.Evaluate(options, nullptr, &result.residuals, nullptr, &result.jacobian)) return {};
  return result;
}

NormalEquations normal_equations(const Evaluation& evaluation) {
  return sum_over_rows(evaluation, [](const Rows&) { return true; });
}

NormalEquations normal_equations_without_view(const Evaluation& evaluation, Index first_pose) {
  NormalEquations sum = sum_over_rows(evaluation, [&](const Rows& rows) {
    const Index last = rows.parameters > 0 ? rows.columns[rows.parameters - 1] : -1;
    return last < first_pose || last >= first_pose + 6;
  });
  sum.parameters.block<6, 6>(first_pose, first_pose).setIdentity();
  return sum;
}

ReducedEquations eliminate_offsets(const NormalEquations& n, double weight) {
  MatrixXd scaled_coupling(n.coupling.rows(), n.coupling.cols());
  VectorXd gradient(n.coupling.cols());
  ReducedEquations result{n.parameters, n.parameters_gradient, n.squares, 0.0};
  for (Index at = 0; at < n.coupling.cols(); at += 3) {
    const Eigen::Matrix3d square =
        n.offsets.middleCols<3>(at) + weight * Eigen::Matrix3d::Identity();
    const Eigen::LLT<Eigen::Matrix3d> cholesky(square);
    const Eigen::Matrix3d inverse_lower = cholesky.matrixL().solve(Eigen::Matrix3d::Identity());
    scaled_coupling.middleCols<3>(at) =
        n.coupling.middleCols<3>(at).lazyProduct(inverse_lower.transpose());
    gradient.segment<3>(at) = inverse_lower * n.offsets_gradient.segment<3>(at);
    result.log_determinant += 2.0 * cholesky.matrixLLT().diagonal().array().log().sum();
  }
  result.parameters -= product(scaled_coupling, scaled_coupling.transpose());
  result.gradient -= product(scaled_coupling, gradient);
  result.squares -= gradient.squaredNorm();
  return result;
}

}  // namespace touchtrace
