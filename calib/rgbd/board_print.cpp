#include "calib/rgbd/board_print.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/normal_equations.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

using Eigen::Index;

constexpr double first_ratio = 0.125;  ///< of the usual one: what is less is no harm
constexpr int most_doublings = 60;
constexpr int print_rounds = 2;  ///< the problem is nearly linear in the offsets

/// The corners about `p`, as seen from the ideal board, nothing known of the offsets.
NormalEquations about_ideal_board(BoardProblem problem, RgbdParameters p) {
  problem.samples.clear();
  problem.prior.print_sigma_m = std::numeric_limits<double>::infinity();
  p.board_offsets_m.resize(std::size_t(problem.observations.board.corners()),
                           Eigen::Vector3d::Zero());
  NormalEquations n = normal_equations(*make_problem(problem, p), problem, p);
  for (Index at = 0; at < n.across.cols(); at += 3) {
    const Eigen::Vector3d& offset_m = p.board_offsets_m[std::size_t(at / 3)];
    const Eigen::Vector3d moved = n.offsets.middleCols<3>(at) * offset_m;
    n.squares += offset_m.dot(moved - 2.0 * n.offsets_gradient.segment<3>(at));
    n.offsets_gradient.segment<3>(at) -= moved;
    n.parameters_gradient -= n.across.middleCols<3>(at) * offset_m;
  }
  return n;
}

/// -2 log of the restricted likelihood, and the variance of the noise, in corner_sigma_px^2, under
/// which it is largest.
struct Cost {
  double value, variance;
};

/// The linear problem of the corners.
struct Corners {
  NormalEquations equations;
  double count;           ///< of coordinates
  double least_variance;  ///< of their noise, where weights lose their meaning

  Cost ideal() const {
    return cost({equations.parameters, equations.parameters_gradient, equations.squares, 0.0});
  }
  /// The offsets have `ratio` times the noise's variance.
  Cost printed(double ratio) const {
    Cost result = cost(without_offsets(equations, 1.0 / ratio));
    result.value += double(equations.across.cols()) * std::log(ratio);
    return result;
  }
  /// Under this one the prior tells as much of an offset as the views do, on average.
  double usual_ratio() const {
    double trace = 0.0;
    for (Index at = 0; at < equations.offsets.cols(); ++at) trace += equations.offsets(at % 3, at);
    return double(equations.offsets.cols()) / trace;
  }

 private:
  Cost cost(const Eliminated& left) const {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(left.parameters);
    const double freedom = count - double(left.parameters.rows());
    const double taken = cholesky.matrixL().solve(left.gradient).squaredNorm();
    const double variance = std::max((left.squares - taken) / freedom, least_variance);
    const double log_determinant = 2.0 * cholesky.matrixLLT().diagonal().array().log().sum();
    return {freedom * std::log(variance) + log_determinant + left.log_determinant, variance};
  }
};

/// Where the parabola through three values a step apart is least, in steps from the middle one.
double vertex(double left, double middle, double right) {
  return 0.5 * (left - right) / (left - 2.0 * middle + right);
}

}  // namespace

BoardPrint likeliest_print(const BoardProblem& problem, const RgbdParameters& parameters) {
  const Corners corners{about_ideal_board(problem, parameters),
                        number_of_coordinates(problem.observations, problem.used),
                        std::pow(smallest_corner_sigma_px / problem.corner_sigma_px, 2)};
  const Cost ideal = corners.ideal();
  double ratio = first_ratio * corners.usual_ratio();
  double left = ideal.value, middle = corners.printed(ratio).value;
  const double penalty = std::log(corners.count);
  if (!(middle < left)) return {0.0, problem.corner_sigma_px * std::sqrt(ideal.variance), -penalty};
  double right = corners.printed(2.0 * ratio).value;
  for (int i = 0; i < most_doublings && right < middle; ++i) {
    ratio *= 2.0;
    left = middle, middle = right, right = corners.printed(2.0 * ratio).value;
  }
  ratio *= std::exp2(vertex(left, middle, right));
  const Cost best = corners.printed(ratio);
  return {std::sqrt(ratio * best.variance), problem.corner_sigma_px * std::sqrt(best.variance),
          ideal.value - best.value - penalty};
}

double choose_print(BoardProblem& problem, RgbdParameters& parameters) {
  BoardProblem trial = problem;
  RgbdParameters printed = parameters;
  double gain = 0.0;
  for (int round = 0; round < print_rounds; ++round) {
    throw_if_interrupted();
    const BoardPrint print = likeliest_print(trial, printed);
    gain = print.bic_gain;
    if (!(gain >= very_strong)) return gain;
    trial.prior.print_sigma_m = print.sigma_m;
    trial.corner_sigma_px = print.corner_sigma_px;
    printed.board_offsets_m.resize(std::size_t(problem.observations.board.corners()),
                                   Eigen::Vector3d::Zero());
    if (!solve(trial, printed)) return gain;
  }
  problem.prior = trial.prior, problem.corner_sigma_px = trial.corner_sigma_px;
  parameters = printed;
  return gain;
}

RgbdParameters board_of(const RgbdCalibration& calibration) {
  RgbdParameters board;
  board.board_warp_m = calibration.board_warp_m;
  for (const auto& offset_m : calibration.details["board_print"]["offsets_m"]) {
    const auto xyz = offset_m.get<std::array<double, 3>>();
    board.board_offsets_m.emplace_back(xyz[0], xyz[1], xyz[2]);
  }
  return board;
}

double noise_of_corners_px(const BoardProblem& problem, const RgbdParameters& parameters) {
  if (print_is_free(problem)) return likeliest_print(problem, parameters).corner_sigma_px;
  return corner_noise_px(problem.observations, problem.used, problem.free_color.size(), parameters);
}

}  // namespace touchtrace
