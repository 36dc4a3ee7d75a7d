#include "calib/rgbd/lens_trials.h"

#include <algorithm>
#include <cmath>

#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/robust_fit.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr int max_trial_iterations = 100;
constexpr double trial_bic_tolerance = 0.001;  ///< error of BIC that trials may leave

/// Unobservable coefficients can be found at parameters that fit this well.
bool fits_well(const BoardProblem& problem, const RgbdParameters& parameters) {
  return rms_of_used_views(problem.observations, problem.used, parameters) <=
         much_worse_ratio * std::sqrt(2.0) * problem.corner_sigma_px;
}

/// Fixes up to `max_count` coefficients at 0. Returns true if there was one.
bool remove_unobservable(BoardProblem& problem, const RgbdParameters& parameters, LensTrial& trial,
                         std::size_t max_count) {
  auto unobservable = find_unobservable_coefficients(problem, parameters);
  if (unobservable.size() > max_count) unobservable.resize(max_count);
  for (auto& [index, name, why] : unobservable) {
    trial.removed.emplace_back(std::move(name), std::move(why));
    std::erase(problem.free_color, index);
  }
  return !unobservable.empty();
}

/// Finds an earlier fit of the same model: same ideal projection, same free coefficients. A
/// coefficient has the same index in all lenses of one projection.
const LensTrial* find_same_model(const std::vector<LensTrial>& earlier, const Lens& lens,
                                 const std::vector<int>& free_color) {
  const auto same = std::ranges::find_if(earlier, [&](const LensTrial& fitted) {
    return fitted.converged() && fitted.free_color == free_color &&
           is_perspective(fitted.parameters.lens) == is_perspective(lens);
  });
  return same == earlier.end() ? nullptr : &*same;
}

/// Solves for the observable coefficients, starting from `start`, and leaves them in
/// problem.free_color. If `start` fits well, unobservable ones are removed before solving, because
/// they make it diverge.
bool solve_for_observable(BoardProblem& problem, const RgbdParameters& start,
                          const std::vector<LensTrial>& earlier, LensTrial& trial) {
  for (;;) {
    throw_if_interrupted();
    if (fits_well(problem, start)) remove_unobservable(problem, start, trial, max_coefficients);
    if (const LensTrial* same = find_same_model(earlier, start.lens, problem.free_color)) {
      trial.parameters = same->parameters;
      trial.parameters.lens = start.lens;
      return true;
    }
    trial.parameters = start;
    for (int i = 4; i < max_intrinsics; ++i)
      if (std::ranges::find(problem.free_color, i) == problem.free_color.end())
        trial.parameters.color[static_cast<std::size_t>(i)] = 0.0;
    const bool converged = solve(problem, trial.parameters);
    if (!remove_unobservable(problem, trial.parameters, trial, 1)) return converged;
  }
}

/// Squares of the corner offsets, as residuals [px^2] under their prior.
double offset_squares(const BoardProblem& problem, const RgbdParameters& parameters) {
  if (!has_free_deformation(problem)) return 0.0;
  double squares_m2 = 0.0;
  for (const auto& offset_m : parameters.corner_offsets_m) squares_m2 += offset_m.squaredNorm();
  return squares_m2 * std::pow(problem.corner_sigma_px / problem.prior.deformation_sigma_m, 2);
}

/// `earlier`: fits of other lenses, reused for the same model.
LensTrial fit_lens(BoardProblem& problem, const LensStart& start,
                   const std::vector<LensTrial>& earlier) {
  LensTrial trial;
  trial.name = lens_name(start.choice.named);
  const double deformation_sigma_m = problem.prior.deformation_sigma_m;
  problem.prior = color_prior(problem.observations, start.choice.lens);
  problem.prior.deformation_sigma_m = deformation_sigma_m;
  problem.free_color = start.choice.free_color;
  if (!solve_for_observable(problem, start.parameters, earlier, trial)) return trial;
  trial.free_color = problem.free_color;
  const double squares = sum_of_squares(problem.observations, problem.used, trial.parameters) +
                         offset_squares(problem, trial.parameters);
  trial.mean_square = std::max(squares / num_corner_coordinates(problem.observations, problem.used),
                               min_corner_sigma_px * min_corner_sigma_px);
  return trial;
}

/// Bayesian information criterion for `count` independent residuals.
double absolute_bic(const LensTrial& trial, double count) {
  return count * std::log(trial.mean_square) +
         static_cast<double>(trial.free_color.size()) * std::log(count);
}

/// BIC gain over the lens `chosen` so far that `trial` needs.
double required_bic_gain(const LensTrial& trial, const LensTrial& chosen, const LensRule& rule) {
  const bool is_simpler = trial.free_color.size() < chosen.free_color.size();
  return is_perspective(trial.parameters.lens) == is_perspective(chosen.parameters.lens) ||
                 (is_simpler && !rule.image_known)
             ? bic_positive_evidence
             : bic_very_strong_evidence;
}

}  // namespace

bool LensTrial::converged() const { return std::isfinite(mean_square); }

std::vector<LensTrial> fit_lenses(BoardProblem problem, const std::vector<LensStart>& starts) {
  problem.max_iterations = max_trial_iterations;
  problem.cost_tolerance =
      trial_bic_tolerance / num_corner_coordinates(problem.observations, problem.used);
  std::vector<LensTrial> trials;
  for (const LensStart& start : starts) trials.push_back(fit_lens(problem, start, trials));
  return trials;
}

std::optional<std::size_t> choose_lens(std::vector<LensTrial>& trials, const LensRule& rule) {
  std::optional<std::size_t> chosen;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].bic = absolute_bic(trials[i], rule.count);
    if (!std::isfinite(trials[i].bic)) continue;
    if (!chosen ||
        trials[i].bic < trials[*chosen].bic - required_bic_gain(trials[i], trials[*chosen], rule))
      chosen = i;
  }
  if (chosen) make_bic_relative(trials, *chosen);
  return chosen;
}

void make_bic_relative(std::vector<LensTrial>& trials, std::size_t chosen) {
  const double reference = trials[chosen].bic;
  for (auto& trial : trials) trial.bic -= reference;
}

}  // namespace touchtrace
