#include "calib/rgbd/target_deformation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/matrix/decomposition.h"
#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/lens_trials.h"
#include "calib/rgbd/normal_equations.h"
#include "engine/base/interrupt.h"
#include "engine/base/parabola.h"

namespace touchtrace {
namespace {

using Eigen::Index;

constexpr double first_ratio = 0.125;  ///< of balanced_ratio(); smaller offsets are harmless
constexpr int max_doublings = 60;
constexpr int num_deformation_rounds = 2;  ///< the problem is nearly linear in the offsets

/// Normal equations linearised at `p`, expressed for offsets from the ideal board instead of from
/// `p`, without a prior on the offsets.
NormalEquations linearize_about_ideal_board(BoardProblem problem, RgbdParameters p) {
  problem.samples.clear();
  problem.prior.deformation_sigma_m = std::numeric_limits<double>::infinity();
  p.corner_offsets_m.resize(std::size_t(problem.observations.board.num_corners()),
                            Eigen::Vector3d::Zero());
  const auto evaluation = evaluate(*make_problem(problem, p), problem, p);
  if (!evaluation) return {};
  NormalEquations n = normal_equations(*evaluation);
  for (Index at = 0; at < n.coupling.cols(); at += 3) {
    const Eigen::Vector3d& offset_m = p.corner_offsets_m[std::size_t(at / 3)];
    const Eigen::Vector3d moved = n.offsets.middleCols<3>(at) * offset_m;
    n.squares += offset_m.dot(moved - 2.0 * n.offsets_gradient.segment<3>(at));
    n.offsets_gradient.segment<3>(at) -= moved;
    n.parameters_gradient -= n.coupling.middleCols<3>(at) * offset_m;
  }
  return n;
}

/// -2 log restricted likelihood, and the noise variance [corner_sigma_px^2] that maximises it.
struct Cost {
  double value, variance;
};

/// Restricted likelihood of the linearised problem.
struct RestrictedLikelihood {
  NormalEquations equations;
  double num_coordinates;
  double min_variance;  ///< lower bound of the noise variance

  Cost ideal() const {
    return cost({equations.parameters, equations.parameters_gradient, equations.squares, 0.0});
  }
  /// `ratio`: variance of the offsets over that of the noise.
  Cost deformed(double ratio) const {
    Cost result = cost(eliminate_offsets(equations, 1.0 / ratio));
    result.value += double(equations.coupling.cols()) * std::log(ratio);
    return result;
  }
  /// Ratio at which prior and views give, on average, the same information about an offset.
  double balanced_ratio() const {
    double trace = 0.0;
    for (Index at = 0; at < equations.offsets.cols(); ++at) trace += equations.offsets(at % 3, at);
    return double(equations.offsets.cols()) / trace;
  }

 private:
  Cost cost(const ReducedEquations& reduced) const {
    const Cholesky cholesky(reduced.parameters);
    const double freedom = num_coordinates - double(reduced.parameters.rows());
    const double taken = cholesky.solve_lower(reduced.gradient).squaredNorm();
    const double variance = std::max((reduced.squares - taken) / freedom, min_variance);
    return {freedom * std::log(variance) + cholesky.log_determinant() + reduced.log_determinant,
            variance};
  }
};

}  // namespace

TargetDeformation estimate_deformation(const BoardProblem& problem,
                                       const RgbdParameters& parameters) {
  const RestrictedLikelihood likelihood{linearize_about_ideal_board(problem, parameters),
                                        num_corner_coordinates(problem.observations, problem.used),
                                        std::pow(min_corner_sigma_px / problem.corner_sigma_px, 2)};
  const Cost ideal = likelihood.ideal();
  double ratio = first_ratio * likelihood.balanced_ratio();
  double left = ideal.value, middle = likelihood.deformed(ratio).value;
  const double penalty = std::log(likelihood.num_coordinates);
  if (!(middle < left)) return {0.0, problem.corner_sigma_px * std::sqrt(ideal.variance), -penalty};
  double right = likelihood.deformed(2.0 * ratio).value;
  for (int i = 0; i < max_doublings && right < middle; ++i) {
    ratio *= 2.0;
    left = middle, middle = right, right = likelihood.deformed(2.0 * ratio).value;
  }
  ratio *= std::exp2(parabola_vertex(left, middle, right));
  const Cost best = likelihood.deformed(ratio);
  return {std::sqrt(ratio * best.variance), problem.corner_sigma_px * std::sqrt(best.variance),
          ideal.value - best.value - penalty};
}

double fit_target_deformation(BoardProblem& problem, RgbdParameters& parameters) {
  BoardProblem trial = problem;
  RgbdParameters deformed = parameters;
  double gain = 0.0;
  for (int round = 0; round < num_deformation_rounds; ++round) {
    throw_if_interrupted();
    const TargetDeformation deformation = estimate_deformation(trial, deformed);
    gain = deformation.bic_gain;
    if (!(gain >= bic_very_strong_evidence)) return gain;
    trial.prior.deformation_sigma_m = deformation.sigma_m;
    trial.corner_sigma_px = deformation.corner_sigma_px;
    deformed.corner_offsets_m.resize(std::size_t(problem.observations.board.num_corners()),
                                     Eigen::Vector3d::Zero());
    if (!solve(trial, deformed)) return gain;
  }
  problem.prior = trial.prior, problem.corner_sigma_px = trial.corner_sigma_px;
  parameters = deformed;
  return gain;
}

RgbdParameters board_parameters(const RgbdCalibration& calibration) {
  RgbdParameters board;
  board.board_warp_m = calibration.board_warp_m;
  for (const auto& offset_m : calibration.details["target_deformation"]["offsets_m"]) {
    const auto xyz = offset_m.get<std::array<double, 3>>();
    board.corner_offsets_m.emplace_back(xyz[0], xyz[1], xyz[2]);
  }
  return board;
}

double estimate_corner_sigma_px(const BoardProblem& problem, const RgbdParameters& parameters) {
  if (has_free_deformation(problem))
    return estimate_deformation(problem, parameters).corner_sigma_px;
  return corner_noise_px(problem.observations, problem.used, problem.free_color.size(), parameters);
}

}  // namespace touchtrace
