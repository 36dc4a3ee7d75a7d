#include "calib/rgbd/board_problem.h"

#include <ceres/ceres.h>
#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <memory>

#include "calib/rgbd/cost_functions.h"

namespace touchtrace {
namespace {

constexpr const char* color_names[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
constexpr const char* depth_names[] = {"depth_from_color.rx",
                                       "depth_from_color.ry",
                                       "depth_from_color.rz",
                                       "depth_from_color.tx",
                                       "depth_from_color.ty",
                                       "depth_from_color.tz",
                                       "depth.fx",
                                       "depth.fy",
                                       "depth.cx",
                                       "depth.cy",
                                       "depth.scale",
                                       "depth.offset"};

template <class Error, int... sizes>
ceres::CostFunction* autodiff(Error error) {
  return new ceres::AutoDiffCostFunction<Error, sizes...>(new Error(std::move(error)));
}

bool is_fixed(const BoardProblem& problem, int color_index) {
  return std::ranges::find(problem.free_color, color_index) == problem.free_color.end();
}

void add_corners(const BoardProblem& problem, std::size_t view, ceres::LossFunction* loss,
                 RgbdParameters& p, ceres::Problem& ceres_problem) {
  const BoardView& seen = problem.observations.views[view];
  for (std::size_t i = 0; i < seen.corners_px.size(); ++i)
    ceres_problem.AddResidualBlock(
        autodiff<CornerError, 2, 9, 6>({problem.observations.board.corner_m(seen.corner(i)),
                                        seen.corners_px[i], problem.corner_sigma_px}),
        loss, p.color.data(), p.camera_from_board[view].data());
}

void fix_color(const BoardProblem& problem, RgbdParameters& p, ceres::Problem& ceres_problem) {
  std::vector<int> fixed;
  for (int i = 0; i < 9; ++i)
    if (is_fixed(problem, i)) fixed.push_back(i);
  if (!fixed.empty())
    ceres_problem.SetManifold(p.color.data(), new ceres::SubsetManifold(9, fixed));
}

void add_depth(const BoardProblem& problem, ceres::LossFunction* loss, RgbdParameters& p,
               ceres::Problem& ceres_problem) {
  for (const auto& s : problem.samples)
    ceres_problem.AddResidualBlock(
        autodiff<DepthError, 1, 6, 6, 4, 2>({s.pixel, s.measured_m, s.sigma_m}), loss,
        p.camera_from_board[s.view].data(), p.depth_from_color.data(), p.depth.data(),
        p.depth_correction.data());
  const auto& prior = problem.prior;
  ceres_problem.AddResidualBlock(autodiff<PriorError<6>, 6, 6>({{}, prior.pose_sigma}), nullptr,
                                 p.depth_from_color.data());
  ceres_problem.AddResidualBlock(
      autodiff<PriorError<4>, 4, 4>({prior.depth_mean, prior.depth_sigma}), nullptr,
      p.depth.data());
  ceres_problem.AddResidualBlock(
      autodiff<PriorError<2>, 2, 2>({{1.0, 0.0}, prior.correction_sigma}), nullptr,
      p.depth_correction.data());
}

std::vector<std::size_t> used_views(const BoardProblem& problem) {
  std::vector<std::size_t> views;
  for (std::size_t view = 0; view < problem.used.size(); ++view)
    if (problem.used[view]) views.push_back(view);
  return views;
}

std::unique_ptr<ceres::Problem> make_problem(const BoardProblem& problem, RgbdParameters& p) {
  auto result = std::make_unique<ceres::Problem>();
  auto* loss = new ceres::HuberLoss(problem.loss_sigmas);
  const auto views = used_views(problem);
  for (std::size_t view : views) add_corners(problem, view, loss, p, *result);
  const auto& prior = problem.prior;
  result->AddResidualBlock(autodiff<PriorError<9>, 9, 9>({prior.color_mean, prior.color_sigma}),
                           nullptr, p.color.data());
  fix_color(problem, p, *result);
  if (!problem.samples.empty()) add_depth(problem, loss, p, *result);
  if (problem.depth_only) {
    result->SetParameterBlockConstant(p.color.data());
    for (std::size_t view : views)
      result->SetParameterBlockConstant(p.camera_from_board[view].data());
  }
  return result;
}

/// J with the columns: colour, depth (if any), then the poses.
Eigen::SparseMatrix<double, Eigen::RowMajor> jacobian(const BoardProblem& problem,
                                                      RgbdParameters& p) {
  const auto ceres_problem = make_problem(problem, p);
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {p.color.data()};
  if (!problem.samples.empty())
    for (double* block : {p.depth_from_color.data(), p.depth.data(), p.depth_correction.data()})
      options.parameter_blocks.push_back(block);
  for (std::size_t view : used_views(problem))
    options.parameter_blocks.push_back(p.camera_from_board[view].data());
  ceres::CRSMatrix crs;
  if (!ceres_problem->Evaluate(options, nullptr, nullptr, nullptr, &crs)) return {};
  return Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
}

/// d log(exp(r + e) exp(r)^-1) / d e: turns an increment of the angle-axis into a rotation from the
/// left.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  Eigen::Matrix3d cross;
  cross << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  if (angle < 1e-6) return Eigen::Matrix3d::Identity() + 0.5 * cross;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / (angle * angle) * cross +
         (angle - std::sin(angle)) / (angle * angle * angle) * cross * cross;
}

}  // namespace

Eigen::Isometry3d pose_of(const std::array<double, 6>& p) {
  Eigen::Matrix3d rotation;
  ceres::AngleAxisToRotationMatrix(p.data(), rotation.data());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() << p[3], p[4], p[5];
  return pose;
}

bool solve(const BoardProblem& problem, RgbdParameters& parameters) {
  RgbdParameters trial = parameters;
  const auto ceres_problem = make_problem(problem, trial);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 500;  // Huber's kinks make narrow valleys long
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, ceres_problem.get(), &summary);
  if (summary.termination_type != ceres::CONVERGENCE || !std::isfinite(summary.final_cost))
    return false;
  parameters = trial;
  return true;
}

std::vector<Eigen::Vector2d> corner_residuals(const BoardObservations& observations,
                                              std::size_t view, const RgbdParameters& p) {
  std::vector<Eigen::Vector2d> residuals;
  const BoardView& seen = observations.views[view];
  for (std::size_t i = 0; i < seen.corners_px.size(); ++i) {
    Eigen::Vector2d error = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    CornerError{observations.board.corner_m(seen.corner(i)), seen.corners_px[i], 1.0}(
        p.color.data(), p.camera_from_board[view].data(), error.data());
    residuals.push_back(-error);
  }
  return residuals;
}

double depth_residual(const DepthSample& sample, const RgbdParameters& p) {
  return (plane_depth_m(sample.pixel, sample.view, p) - p.depth_correction[1]) /
             p.depth_correction[0] -
         sample.measured_m;
}

double plane_depth_m(const Eigen::Vector2d& pixel, std::size_t view, const RgbdParameters& p) {
  return plane_depth(pixel, p.camera_from_board[view].data(), p.depth_from_color.data(),
                     p.depth.data());
}

std::vector<std::string> parameter_names(const BoardProblem& problem) {
  std::vector<std::string> names;
  for (int i : problem.free_color) names.push_back(fmt::format("color.{}", color_names[i]));
  if (!problem.samples.empty())
    names.insert(names.end(), std::begin(depth_names), std::end(depth_names));
  return names;
}

Eigen::MatrixXd covariance(const BoardProblem& problem, RgbdParameters parameters) {
  const auto j = jacobian(problem, parameters);
  const Eigen::MatrixXd information = Eigen::MatrixXd(j.transpose() * j);
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (information.size() == 0 || !scale.allFinite()) return {};
  const Eigen::LLT<Eigen::MatrixXd> cholesky(scale.asDiagonal() * information * scale.asDiagonal());
  if (cholesky.info() != Eigen::Success) return {};
  const auto size = static_cast<Eigen::Index>(parameter_names(problem).size());
  const Eigen::MatrixXd selection = Eigen::MatrixXd::Identity(information.rows(), size);
  Eigen::MatrixXd marginal = cholesky.solve(selection).topRows(size);
  marginal = scale.head(size).asDiagonal() * marginal * scale.head(size).asDiagonal();
  if (problem.samples.empty()) return marginal;
  const auto first = static_cast<Eigen::Index>(problem.free_color.size());
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(size, size);
  turn.block<3, 3>(first, first) =
      left_jacobian(Eigen::Vector3d(parameters.depth_from_color.data()));
  return turn * marginal * turn.transpose();
}

}  // namespace touchtrace
