#include <ceres/ceres.h>
#include <fmt/core.h>

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/normal_equations.h"
#include "calib/rgbd/rotation.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

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
constexpr int num_draws = 4;  ///< each is used with both signs
/// Sum of squares that a draw may add, over what a quadratic function would. Coefficients that are
/// almost unobservable are drawn so far away that the lens folds.
constexpr double max_excess = 3.0;

/// Equations at `p`; empty if they cannot be evaluated. Their parameters are information().
ReducedEquations equations_at(CeresProblem& ceres_problem, const BoardProblem& problem,
                              RgbdParameters& p) {
  const auto evaluation = evaluate(ceres_problem, problem, p);
  if (!evaluation) return {};
  return eliminate_offsets(normal_equations(*evaluation));
}

void add_step(const BoardProblem& problem, RgbdParameters& p, const VectorXd& step) {
  Index at = 0;
  for (int i : problem.free_color) p.color[static_cast<std::size_t>(i)] += step[at++];
  const auto add = [&](double* block, int size) {
    for (int i = 0; i < size; ++i) block[i] += step[at++];
  };
  add(p.board_warp_m.data(), 2);
  if (!problem.samples.empty()) {
    add(p.depth_from_color.data(), 6), add(p.depth.data(), 4), add(p.depth_correction.data(), 2);
    if (problem.free_delay) add(&p.depth_delay_s, 1);
  }
  for (std::size_t view : used_views(problem)) add(p.camera_from_board[view].data(), 6);
}

MatrixXd with_left_rotations(const BoardProblem& problem, const RgbdParameters& p,
                             const MatrixXd& marginal) {
  if (marginal.size() == 0) return marginal;
  const MatrixXd jacobian = left_rotation_jacobian(problem, p, marginal.rows());
  return congruence(jacobian, marginal);
}

}  // namespace

std::vector<std::string> parameter_names(const BoardProblem& problem, const Lens& lens) {
  const auto intrinsics = intrinsic_names(lens);
  std::vector<std::string> names;
  for (int i : problem.free_color)
    names.push_back("color." + intrinsics[static_cast<std::size_t>(i)]);
  names.insert(names.end(), {"board.warp_x", "board.warp_y"});
  if (problem.samples.empty()) return names;
  names.insert(names.end(), std::begin(depth_names), std::end(depth_names));
  if (problem.free_delay) names.emplace_back("depth.delay");
  return names;
}

MatrixXd left_rotation_jacobian(const BoardProblem& problem, const RgbdParameters& p, Index size) {
  MatrixXd jacobian = MatrixXd::Identity(size, size);
  if (problem.samples.empty()) return jacobian;
  const auto first = static_cast<Index>(problem.free_color.size()) + 2;
  jacobian.block<3, 3>(first, first) = left_jacobian(Eigen::Vector3d(p.depth_from_color.data()));
  return jacobian;
}

MatrixXd information(const BoardProblem& problem, RgbdParameters p) {
  return equations_at(*make_problem(problem, p), problem, p).parameters;
}

MatrixXd marginal_covariance(const MatrixXd& information, Eigen::Index size) {
  const Cholesky cholesky(information);
  return cholesky.is_valid() ? cholesky.inverse_corner(size) : MatrixXd();
}

MatrixXd covariance(const BoardProblem& problem, const RgbdParameters& p) {
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  return with_left_rotations(problem, p, marginal_covariance(information(problem, p), size));
}

MatrixXd covariance_of_estimate(const BoardProblem& problem, const RgbdParameters& estimate) {
  RgbdParameters p = estimate;
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  const auto ceres_problem = make_problem(problem, p);
  const ReducedEquations here = equations_at(*ceres_problem, problem, p);
  const Cholesky cholesky(here.parameters);
  if (!cholesky.is_valid()) return {};
  RandomStream random(1, "around the estimate");
  MatrixXd mean = MatrixXd::Zero(size, size);
  int num_valid = 0;
  for (int i = 0; i < num_draws; ++i) {
    VectorXd normal(here.gradient.size());
    for (double& value : normal) value = random.normal();
    const VectorXd step = cholesky.solve_upper(normal);
    for (double sign : {1.0, -1.0}) {
      p = estimate;
      add_step(problem, p, sign * step);
      const ReducedEquations there = equations_at(*ceres_problem, problem, p);
      if (there.parameters.size() == 0) continue;  // the lens cannot project a corner
      if (there.squares - here.squares > max_excess * normal.squaredNorm()) continue;
      const MatrixXd marginal = schur_complement(there.parameters, size);
      if (!marginal.allFinite() || marginal.size() == 0) continue;
      mean += marginal, ++num_valid;
    }
  }
  const MatrixXd plain = cholesky.inverse_corner(size);
  const Cholesky plain_cholesky(plain);
  if (num_valid == 0 || !plain_cholesky.is_valid())
    return with_left_rotations(problem, estimate, plain);
  // C S C as R (R' S R) R', which stays positive definite
  const MatrixXd root = plain_cholesky.lower();
  const MatrixXd relative = congruence(root.transpose(), mean / num_valid);
  return with_left_rotations(problem, estimate, congruence(root, relative));
}

}  // namespace touchtrace
