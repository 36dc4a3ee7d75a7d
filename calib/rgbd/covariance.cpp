#include <ceres/ceres.h>
#include <fmt/core.h>

#include <Eigen/Cholesky>

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
constexpr int draws = 4;  ///< pairs: each also with the opposite sign

/// J'J over parameter_names() and the poses, the board's offsets marginalised out; empty if it
/// cannot be evaluated.
MatrixXd information_at(const ceres::Problem& ceres_problem, const BoardProblem& problem,
                        RgbdParameters& p) {
  return without_offsets(normal_equations(ceres_problem, problem, p)).parameters;
}

/// Cholesky of the information with its diagonal scaled to 1.
struct ScaledInverse {
  VectorXd scale;
  Eigen::LLT<MatrixXd> cholesky;
  bool good = false;

  explicit ScaledInverse(const MatrixXd& matrix) {
    if (matrix.size() == 0) return;
    scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
    if (!scale.allFinite()) return;
    cholesky.compute(scale.asDiagonal() * matrix * scale.asDiagonal());
    good = cholesky.info() == Eigen::Success;
  }
  /// Of the first `size`.
  MatrixXd marginal(Index size) const {
    const MatrixXd selection = MatrixXd::Identity(scale.size(), size);
    const MatrixXd top = cholesky.solve(selection).topRows(size);
    return scale.head(size).asDiagonal() * top * scale.head(size).asDiagonal();
  }
  /// A draw with the inverse as its covariance, from independent normal numbers.
  VectorXd draw(const VectorXd& normal) const {
    return scale.cwiseProduct(cholesky.matrixU().solve(normal));
  }
};

/// The information on the first `size` once the rest is marginalised out.
MatrixXd marginal_information(const MatrixXd& all, Index size) {
  const Index rest = all.rows() - size;
  const MatrixXd across = all.bottomLeftCorner(rest, size);
  const Eigen::LLT<MatrixXd> cholesky(all.bottomRightCorner(rest, rest));
  if (cholesky.info() != Eigen::Success) return {};
  return all.topLeftCorner(size, size) - across.transpose() * cholesky.solve(across);
}

void move(const BoardProblem& problem, RgbdParameters& p, const VectorXd& step) {
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

/// From increments of the angle-axis to rotations from the left.
MatrixXd turned(const BoardProblem& problem, const RgbdParameters& p, const MatrixXd& marginal) {
  if (problem.samples.empty() || marginal.size() == 0) return marginal;
  const auto first = static_cast<Index>(problem.free_color.size()) + 2;
  MatrixXd turn = MatrixXd::Identity(marginal.rows(), marginal.cols());
  turn.block<3, 3>(first, first) = left_jacobian(Eigen::Vector3d(p.depth_from_color.data()));
  return turn * marginal * turn.transpose();
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

MatrixXd information(const BoardProblem& problem, RgbdParameters p) {
  return information_at(*make_problem(problem, p), problem, p);
}

MatrixXd marginal_covariance(const MatrixXd& information, Eigen::Index size) {
  const ScaledInverse inverse(information);
  return inverse.good ? inverse.marginal(size) : MatrixXd();
}

MatrixXd covariance(const BoardProblem& problem, const RgbdParameters& p) {
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  return turned(problem, p, marginal_covariance(information(problem, p), size));
}

MatrixXd covariance_of_estimate(const BoardProblem& problem, const RgbdParameters& estimate) {
  RgbdParameters p = estimate;
  const auto size = static_cast<Index>(parameter_names(problem, p.lens).size());
  const auto ceres_problem = make_problem(problem, p);
  const ScaledInverse inverse(information_at(*ceres_problem, problem, p));
  if (!inverse.good) return {};
  RandomStream random(1, "around the estimate");
  MatrixXd mean = MatrixXd::Zero(size, size);
  int counted = 0;
  for (int i = 0; i < draws; ++i) {
    VectorXd normal(inverse.scale.size());
    for (double& value : normal) value = random.normal();
    const VectorXd step = inverse.draw(normal);
    for (double sign : {1.0, -1.0}) {
      p = estimate;
      move(problem, p, sign * step);
      const MatrixXd there = information_at(*ceres_problem, problem, p);
      if (there.size() == 0) continue;  // behind the camera, or where the lens sees nothing
      const MatrixXd marginal = marginal_information(there, size);
      if (!marginal.allFinite() || marginal.size() == 0) continue;
      mean += marginal, ++counted;
    }
  }
  const MatrixXd plain = inverse.marginal(size);
  if (counted == 0) return turned(problem, estimate, plain);
  return turned(problem, estimate, plain * (mean / counted) * plain);
}

}  // namespace touchtrace
