#include "calib/rgbd/color_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/initial_guess.h"
#include "calib/rgbd/statistics.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double outlier_ratio = 3.0;  ///< a view's RMS over the median view's
constexpr double smallest_sigma_px =
    1e-6;  ///< of data without noise, where weights lose their meaning
constexpr int robust_rounds = 2;

/// fx fy cx cy p1 p2, and k1 k2 of two, k1 k2 k3 of three radial coefficients.
std::vector<int> free_parameters(int radial) {
  if (radial == 0) return {0, 1, 2, 3, 6, 7};
  if (radial == 2) return {0, 1, 2, 3, 4, 5, 6, 7};
  return {0, 1, 2, 3, 4, 5, 6, 7, 8};
}

std::vector<double> view_rms(const BoardObservations& observations,
                             const RgbdParameters& parameters) {
  std::vector<double> values;
  for (std::size_t view = 0; view < observations.views.size(); ++view)
    values.push_back(rms(corner_residuals(observations, view, parameters)));
  return values;
}

double sum_of_squares(const BoardObservations& observations, const std::vector<bool>& used,
                      const RgbdParameters& parameters) {
  double sum = 0.0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view])
      for (const auto& residual : corner_residuals(observations, view, parameters))
        sum += residual.squaredNorm();
  return sum;
}

double number_of_coordinates(const BoardObservations& observations, const std::vector<bool>& used) {
  std::size_t corners = 0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view]) corners += observations.views[view].corners_px.size();
  return 2.0 * static_cast<double>(corners);
}

/// Rounds of robust fit; each takes its scale and its outlier views from the one before.
bool fit_robustly(BoardProblem& problem, RgbdParameters& parameters) {
  bool converged = solve(problem, parameters);  // without distortion, to come near
  problem.free_color = free_parameters(2);
  for (int round = 0; round < robust_rounds; ++round) {
    throw_if_interrupted();
    converged = solve(problem, parameters);
    const auto values = view_rms(problem.observations, parameters);
    const double typical = median(values);
    for (std::size_t view = 0; view < values.size(); ++view)
      problem.used[view] = values[view] <= outlier_ratio * typical;
    problem.corner_sigma_px = std::max(typical / std::sqrt(2.0), smallest_sigma_px);
  }
  return converged;
}

/// Solves with `radial` coefficients from `parameters`, whose others become 0. Returns BIC;
/// infinite if there is no solution.
double fit_with(int radial, BoardProblem& problem, RgbdParameters& parameters) {
  throw_if_interrupted();
  problem.free_color = free_parameters(radial);
  for (int i = 4; i < 9; ++i)
    if (std::ranges::find(problem.free_color, i) == problem.free_color.end())
      parameters.color[static_cast<std::size_t>(i)] = 0.0;
  if (!solve(problem, parameters)) return std::numeric_limits<double>::infinity();
  const double count = number_of_coordinates(problem.observations, problem.used);
  const double squares =
      std::max(sum_of_squares(problem.observations, problem.used, parameters), count * 1e-24);
  return count * std::log(squares / count) + radial * std::log(count);
}

}  // namespace

double rms(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0.0;
  for (const auto& residual : residuals) sum += residual.squaredNorm();
  return residuals.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(residuals.size()));
}

double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters) {
  const double unknowns =
      static_cast<double>(free_color) + 6.0 * static_cast<double>(std::ranges::count(used, true));
  const double freedom = std::max(1.0, number_of_coordinates(observations, used) - unknowns);
  return std::max(std::sqrt(sum_of_squares(observations, used, parameters) / freedom),
                  smallest_sigma_px);
}

ColorFit fit_color(const BoardObservations& observations, const Prior& prior,
                   const std::vector<int>& radial_choices) {
  BoardProblem problem{observations, std::vector<bool>(observations.views.size(), true), {}, prior};
  RgbdParameters start = initial_guess(observations);
  ColorFit fit;
  if (!fit_robustly(problem, start)) return fit;
  double best = std::numeric_limits<double>::infinity();
  for (int radial : radial_choices) {
    RgbdParameters parameters = start;
    fit.bic[radial] = fit_with(radial, problem, parameters);
    if (!(fit.bic[radial] < best)) continue;
    best = fit.bic[radial];
    fit.parameters = parameters;
    fit.free_color = problem.free_color;
    fit.radial_coefficients = radial;
    fit.converged = true;
  }
  std::erase_if(fit.bic, [](const auto& choice) { return !std::isfinite(choice.second); });
  for (auto& [radial, bic] : fit.bic) bic -= best;
  fit.used = problem.used;
  if (fit.converged)
    fit.corner_sigma_px =
        corner_noise_px(observations, fit.used, fit.free_color.size(), fit.parameters);
  return fit;
}

}  // namespace touchtrace
