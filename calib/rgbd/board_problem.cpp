#include "calib/rgbd/board_problem.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <limits>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/cost_functions.h"

namespace touchtrace {
namespace {

using DepthCost = ceres::AutoDiffCostFunction<DepthError, 1, 6, 6, 4, 2, 2, 1>;

void add_corners(const BoardProblem& problem, std::size_t view, ceres::LossFunction* loss,
                 RgbdParameters& p, CeresProblem& ceres_problem) {
  const CalibrationTarget& board = problem.observations.board;
  const BoardView& seen = problem.observations.views[view];
  for (std::size_t i = 0; i < seen.corners_px.size(); ++i) {
    const int corner = seen.corner_id(i);
    const Eigen::Vector3d flat_m = board.corner_m(corner);
    std::vector<double*> blocks{p.color.data(), p.camera_from_board[view].data(),
                                p.board_warp_m.data()};
    if (has_free_deformation(problem))
      blocks.push_back(p.corner_offsets_m[std::size_t(corner)].data());
    ceres_problem.problem.AddResidualBlock(
        new CornerCost({p.lens, flat_m, board.warp_basis(flat_m.head<2>()), seen.corners_px[i],
                        problem.corner_sigma_px},
                       ceres_problem.rotations[view], has_free_deformation(problem)),
        loss, blocks);
  }
}

void add_color(const BoardProblem& problem, ceres::LossFunction* loss, RgbdParameters& p,
               CeresProblem& ceres_problem) {
  const int size = num_intrinsics(p.lens);
  for (std::size_t view : used_views(problem)) add_corners(problem, view, loss, p, ceres_problem);
  ceres_problem.problem.AddResidualBlock(
      gaussian_prior(std::span(problem.prior.color_mean).first(size),
                     std::span(problem.prior.color_sigma).first(size)),
      nullptr, p.color.data());
  std::vector<int> fixed;
  for (int i = 0; i < size; ++i)
    if (std::ranges::find(problem.free_color, i) == problem.free_color.end()) fixed.push_back(i);
  if (!fixed.empty())
    ceres_problem.problem.SetManifold(p.color.data(), new ceres::SubsetManifold(size, fixed));
}

/// Corners that no view shows get a prior, too: it keeps their offsets at 0.
void add_deformation(const BoardProblem& problem, RgbdParameters& p,
                     ceres::Problem& ceres_problem) {
  const double sigma_m = problem.prior.deformation_sigma_m;
  for (auto& offset_m : p.corner_offsets_m) {
    ceres_problem.AddResidualBlock(gaussian_prior({}, std::array{sigma_m, sigma_m, sigma_m}),
                                   nullptr, offset_m.data());
    if (problem.estimated != Estimated::everything)
      ceres_problem.SetParameterBlockConstant(offset_m.data());
  }
}

void add_depth(const BoardProblem& problem, ceres::LossFunction* loss, RgbdParameters& p,
               ceres::Problem& ceres_problem) {
  for (const auto& s : problem.samples)
    ceres_problem.AddResidualBlock(new DepthCost(new DepthError{s}), loss,
                                   p.camera_from_board[s.view].data(), p.depth_from_color.data(),
                                   p.depth.data(), p.depth_correction.data(), p.board_warp_m.data(),
                                   &p.depth_delay_s);
  const auto& prior = problem.prior;
  const auto add_prior = [&](ceres::CostFunction* error, double* block) {
    ceres_problem.AddResidualBlock(error, nullptr, block);
  };
  add_prior(gaussian_prior({}, prior.pose_sigma), p.depth_from_color.data());
  add_prior(gaussian_prior(prior.depth_mean, prior.depth_sigma), p.depth.data());
  add_prior(gaussian_prior(std::array{1.0, 0.0}, prior.correction_sigma),
            p.depth_correction.data());
  if (problem.free_delay)
    add_prior(gaussian_prior({}, {&prior.delay_sigma_s, 1}), &p.depth_delay_s);
  else
    ceres_problem.SetParameterBlockConstant(&p.depth_delay_s);
}

/// Fixes colour camera, board and its poses, as far as they are not estimated.
void fix_parameters(const BoardProblem& problem, RgbdParameters& p, ceres::Problem& ceres_problem) {
  const Estimated estimated = problem.estimated;
  if (estimated == Estimated::everything) return;
  ceres_problem.SetParameterBlockConstant(p.board_warp_m.data());
  if (estimated != Estimated::color_camera) ceres_problem.SetParameterBlockConstant(p.color.data());
  if (estimated != Estimated::board_poses)
    for (std::size_t view : used_views(problem))
      ceres_problem.SetParameterBlockConstant(p.camera_from_board[view].data());
}

ceres::Problem::Options problem_options(ViewRotations& rotations) {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;  // the blocks are members of one struct
  options.evaluation_callback = &rotations;
  return options;
}

}  // namespace

std::vector<std::size_t> used_views(const BoardProblem& problem) {
  std::vector<std::size_t> views;
  for (std::size_t view = 0; view < problem.used.size(); ++view)
    if (problem.used[view]) views.push_back(view);
  return views;
}

ViewRotations::ViewRotations(const std::vector<std::array<double, 6>>& camera_from_board)
    : camera_from_board_(camera_from_board), rotations_(camera_from_board.size()) {
  PrepareForEvaluation(true, true);
}

void ViewRotations::PrepareForEvaluation(bool, bool new_evaluation_point) {
  if (!new_evaluation_point) return;
  for (std::size_t view = 0; view < rotations_.size(); ++view) {
    const Eigen::Vector3d angle_axis(camera_from_board_[view].data());
    rotations_[view] = {rotation_matrix(angle_axis), left_jacobian(angle_axis)};
  }
}

CeresProblem::CeresProblem(const RgbdParameters& p)
    : rotations(p.camera_from_board), problem(problem_options(rotations)) {}

std::unique_ptr<CeresProblem> make_problem(const BoardProblem& problem, RgbdParameters& p) {
  auto result = std::make_unique<CeresProblem>(p);
  ceres::Problem& ceres_problem = result->problem;
  auto* loss = new ceres::HuberLoss(problem.loss_sigmas);
  add_color(problem, loss, p, *result);
  const double warp_sigma_m = problem.prior.warp_sigma_m;
  ceres_problem.AddResidualBlock(gaussian_prior({}, std::array{warp_sigma_m, warp_sigma_m}),
                                 nullptr, p.board_warp_m.data());
  if (has_free_deformation(problem)) add_deformation(problem, p, ceres_problem);
  if (!problem.samples.empty()) add_depth(problem, loss, p, ceres_problem);
  fix_parameters(problem, p, ceres_problem);
  return result;
}

Eigen::Vector3d deformed_corner_m(const CalibrationTarget& board, int corner,
                                  const RgbdParameters& p) {
  Eigen::Vector3d corner_m = board.corner_m(corner);
  corner_m.z() += board.warp_basis(corner_m.head<2>())
                      .dot(Eigen::Map<const Eigen::Vector2d>(p.board_warp_m.data()));
  if (!p.corner_offsets_m.empty()) corner_m += p.corner_offsets_m[std::size_t(corner)];
  return corner_m;
}

Eigen::Isometry3d pose_of(const std::array<double, 6>& p) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_matrix({p[0], p[1], p[2]});
  pose.translation() << p[3], p[4], p[5];
  return pose;
}

ceres::CostFunction* gaussian_prior(std::span<const double> mean, std::span<const double> sigma) {
  const auto size = static_cast<Eigen::Index>(sigma.size());
  Eigen::VectorXd centre = Eigen::VectorXd::Zero(size);
  std::ranges::copy(mean, centre.begin());
  const Eigen::Map<const Eigen::VectorXd> sigmas(sigma.data(), size);
  return new ceres::NormalPrior(sigmas.cwiseInverse().asDiagonal().toDenseMatrix(), centre);
}

bool minimize(ceres::Problem& problem, const SolverLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.cost_tolerance;
  options.parameter_tolerance = limits.parameter_tolerance;
  options.num_threads = limits.num_threads;
  options.initial_trust_region_radius = 1e8;  // close to Gauss-Newton: half the iterations
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE && std::isfinite(summary.final_cost);
}

bool solve(const BoardProblem& problem, RgbdParameters& parameters) {
  RgbdParameters trial = parameters;
  const auto ceres_problem = make_problem(problem, trial);
  if (!minimize(ceres_problem->problem, {problem.max_iterations, problem.cost_tolerance,
                                         problem.parameter_tolerance, problem.num_threads}))
    return false;
  parameters = trial;
  return true;
}

std::vector<Eigen::Vector2d> corner_residuals(const BoardObservations& observations,
                                              std::size_t view, const RgbdParameters& p) {
  std::vector<Eigen::Vector2d> residuals;
  const BoardView& seen = observations.views[view];
  const Eigen::Isometry3d pose = pose_of(p.camera_from_board[view]);
  for (std::size_t i = 0; i < seen.corners_px.size(); ++i) {
    const Eigen::Vector2d pixel = project_point(
        p.lens, p.color.data(), pose * deformed_corner_m(observations.board, seen.corner_id(i), p));
    if (pixel.allFinite())
      residuals.push_back(seen.corners_px[i] - pixel);
    else
      residuals.emplace_back(Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()));
  }
  return residuals;
}

double depth_residual(const DepthSample& sample, const RgbdParameters& p) {
  return (board_depth_m(sample, p) - p.depth_correction[1]) / p.depth_correction[0] -
         sample.measured_m;
}

double board_depth_m(const DepthSample& sample, const RgbdParameters& p) {
  return board_depth(sample, p.camera_from_board[sample.view].data(), p.depth_from_color.data(),
                     p.depth.data(), p.board_warp_m.data(), p.depth_delay_s);
}

}  // namespace touchtrace
