#include "calib/rgbd/color_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/initial_guess.h"
#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/statistics.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double outlier_ratio = 3.0;  ///< a view's RMS over the median view's
constexpr int robust_rounds = 2;
constexpr double poor_px = 1.0;
constexpr double much_worse = 2.0;
constexpr double settling_tolerance = 1e-5;
constexpr int most_trial_iterations = 100;
constexpr double trial_bic_error = 0.001;  ///< of a trial that is not solved out

std::vector<double> view_rms(const BoardProblem& problem, const RgbdParameters& parameters) {
  std::vector<double> values;
  for (std::size_t view = 0; view < problem.used.size(); ++view)
    values.push_back(rms(corner_residuals(problem.observations, view, parameters)));
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

double median_of(const std::vector<double>& values, const std::vector<bool>& chosen) {
  std::vector<double> some;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (chosen[i]) some.push_back(values[i]);
  return median(std::move(some));
}

/// The views settled through one kind of lens.
struct Settled {
  RgbdParameters parameters;
  std::vector<bool> used;
  double sigma_px = 1.0, typical_rms_px = unbounded;  ///< of the median view; infinite: no solution
};

/// Rounds of robust fit; each takes its scale and its outlier views from the one before.
Settled settle(const BoardObservations& observations, const std::vector<bool>& usable,
               const LensChoice& choice) {
  Settled result{initial_guess(observations, choice.lens), usable};
  BoardProblem problem{observations, usable, {}, color_prior(observations, choice.lens)};
  problem.cost_tolerance = problem.parameter_tolerance = settling_tolerance;
  solve(problem, result.parameters);  // without distortion, to come near
  problem.free_color = choice.free_color;
  for (int round = 0; round < robust_rounds; ++round) {
    throw_if_interrupted();
    const bool converged = solve(problem, result.parameters);
    const auto values = view_rms(problem, result.parameters);
    const double typical = median_of(values, usable);
    for (std::size_t view = 0; view < values.size(); ++view)
      problem.used[view] = usable[view] && values[view] <= outlier_ratio * typical;
    problem.corner_sigma_px = std::max(typical / std::sqrt(2.0), smallest_corner_sigma_px);
    result.typical_rms_px = converged && std::isfinite(typical) ? typical : unbounded;
  }
  result.used = problem.used, result.sigma_px = problem.corner_sigma_px;
  return result;
}

/// Through one lens of each kind that is asked for; through a fisheye, too, where radtan4 fails.
struct Settlements {
  std::optional<Settled> perspective, equidistant;

  /// Where a fit of `lens` starts: from its own kind, or, if that explains the views much worse,
  /// without distortion where the other kind places camera and boards.
  RgbdParameters start_of(const Lens& lens) const {
    const Settled& own = is_perspective(lens) ? *perspective : *equidistant;
    if (!(own.typical_rms_px > much_worse * better().typical_rms_px)) return own.parameters;
    RgbdParameters start = better().parameters;
    std::fill(start.color.begin() + 4, start.color.end(), 0.0);
    return start;
  }
  const Settled& better() const {
    if (!perspective) return *equidistant;
    if (!equidistant) return *perspective;
    return perspective->typical_rms_px <= equidistant->typical_rms_px ? *perspective : *equidistant;
  }
};

struct Fitted {
  RgbdParameters parameters;
  std::vector<int> free_color;
  double bic = unbounded;
};

/// What the data cannot tell is seen where a fit explains them.
bool explains(const BoardProblem& problem, const RgbdParameters& parameters) {
  return rms_of_used(problem.observations, problem.used, parameters) <=
         much_worse * std::sqrt(2.0) * problem.corner_sigma_px;
}

bool remove_untold(BoardProblem& problem, const RgbdParameters& parameters, LensTrial& trial,
                   std::size_t most) {
  auto untold = untold_coefficients(problem, parameters);
  if (untold.size() > most) untold.resize(most);
  for (auto& [index, name, why] : untold) {
    trial.removed.emplace_back(std::move(name), std::move(why));
    std::erase(problem.free_color, index);
  }
  return !untold.empty();
}

/// A lens of the same kind with the same free coefficients is the same lens: each has those of the
/// simpler ones in the same places.
const Fitted* same_lens(const std::vector<Fitted>& earlier, const Lens& lens,
                        const std::vector<int>& free_color) {
  const auto same = std::ranges::find_if(earlier, [&](const Fitted& fitted) {
    return fitted.free_color == free_color &&
           is_perspective(fitted.parameters.lens) == is_perspective(lens);
  });
  return same == earlier.end() ? nullptr : &*same;
}

/// Solves from `start` for the free coefficients alone; if `start` shows already which those are,
/// before the fit wanders off. Leaves those in problem.free_color.
bool solve_for_told(BoardProblem& problem, const RgbdParameters& start,
                    const std::vector<Fitted>& earlier, RgbdParameters& parameters,
                    LensTrial& trial) {
  for (;;) {
    throw_if_interrupted();
    if (explains(problem, start)) remove_untold(problem, start, trial, max_coefficients);
    if (const Fitted* same = same_lens(earlier, start.lens, problem.free_color)) {
      parameters = same->parameters;
      parameters.lens = start.lens;
      return true;
    }
    parameters = start;
    for (int i = 4; i < max_intrinsics; ++i)
      if (std::ranges::find(problem.free_color, i) == problem.free_color.end())
        parameters.color[static_cast<std::size_t>(i)] = 0.0;
    const bool converged = solve(problem, parameters);
    if (!remove_untold(problem, parameters, trial, 1)) return converged;
  }
}

/// `earlier`: what other lenses came to.
Fitted fit_lens(BoardProblem& problem, const LensChoice& choice, RgbdParameters start,
                const std::vector<Fitted>& earlier, LensTrial& trial) {
  Fitted fitted;
  start.lens = choice.lens;
  problem.prior = color_prior(problem.observations, choice.lens);
  problem.free_color = choice.free_color;
  problem.most_iterations = most_trial_iterations;
  const double count = number_of_coordinates(problem.observations, problem.used);
  problem.cost_tolerance = trial_bic_error / count;
  if (!solve_for_told(problem, start, earlier, fitted.parameters, trial)) return fitted;
  fitted.free_color = problem.free_color;
  const double squares =
      std::max(sum_of_squares(problem.observations, problem.used, fitted.parameters),
               count * smallest_corner_sigma_px * smallest_corner_sigma_px);
  fitted.bic = count * std::log(squares / count) +
               static_cast<double>(fitted.free_color.size()) * std::log(count);
  return fitted;
}

Settlements settlements(const BoardObservations& observations, const std::vector<bool>& usable,
                        const std::vector<LensChoice>& choices) {
  Settlements all;
  for (const LensChoice& choice : choices) {
    auto& kind = is_perspective(choice.lens) ? all.perspective : all.equidistant;
    if (!kind)
      kind = settle(observations, usable,
                    is_perspective(choice.lens) ? lens_choice("radtan4") : choice);
  }
  if (!all.equidistant && all.perspective->typical_rms_px > poor_px)
    all.equidistant = settle(observations, usable, lens_choice("fisheye4"));
  return all;
}

/// By how much a lens must be better than the one chosen so far.
double asked_of(const Lens& lens, const ColorFit& fit) {
  if (!fit.converged) return 0.0;
  return is_perspective(lens) == is_perspective(fit.parameters.lens) ? worth_a_mention
                                                                     : very_strong;
}

}  // namespace

double number_of_coordinates(const BoardObservations& observations, const std::vector<bool>& used) {
  std::size_t corners = 0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view]) corners += observations.views[view].corners_px.size();
  return 2.0 * static_cast<double>(corners);
}

BoardProblem color_problem(const BoardObservations& observations, const ColorFit& fit) {
  BoardProblem problem{
      observations, fit.used, {}, color_prior(observations, fit.parameters.lens), fit.free_color};
  problem.corner_sigma_px = fit.corner_sigma_px;
  return problem;
}

double rms(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0.0;
  for (const auto& residual : residuals) sum += residual.squaredNorm();
  return residuals.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(residuals.size()));
}

double rms_of_used(const BoardObservations& observations, const std::vector<bool>& used,
                   const RgbdParameters& parameters) {
  const double corners = 0.5 * number_of_coordinates(observations, used);
  return corners > 0.0 ? std::sqrt(sum_of_squares(observations, used, parameters) / corners) : 0.0;
}

double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters) {
  const double unknowns = static_cast<double>(free_color) + 2.0 +
                          6.0 * static_cast<double>(std::ranges::count(used, true));
  const double freedom = std::max(1.0, number_of_coordinates(observations, used) - unknowns);
  return std::max(std::sqrt(sum_of_squares(observations, used, parameters) / freedom),
                  smallest_corner_sigma_px);
}

ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names) {
  const auto choices = lens_choices(names);
  const Settlements settled = settlements(observations, usable, choices);
  ColorFit fit;
  if (!std::isfinite(settled.better().typical_rms_px)) return fit;
  fit.used = settled.better().used;
  BoardProblem problem{observations, fit.used, {}, {}};
  problem.corner_sigma_px = settled.better().sigma_px;
  fit.corner_sigma_px = problem.corner_sigma_px;
  double best = unbounded;
  std::vector<Fitted> earlier;
  for (const LensChoice& choice : choices) {
    LensTrial trial{lens_name(choice.named), 0.0, {}};
    const Fitted fitted = fit_lens(problem, choice, settled.start_of(choice.lens), earlier, trial);
    trial.bic = fitted.bic;
    if (std::isfinite(fitted.bic) && fitted.bic < best - asked_of(choice.lens, fit)) {
      best = fitted.bic;
      fit.parameters = fitted.parameters, fit.free_color = fitted.free_color;
      fit.chosen = trial.name, fit.converged = true;
    }
    fit.trials.push_back(std::move(trial));
    if (std::isfinite(fitted.bic)) earlier.push_back(fitted);
  }
  for (auto& trial : fit.trials) trial.bic -= best;
  fit.converged = fit.converged && solve(color_problem(observations, fit), fit.parameters);
  if (fit.converged)
    fit.corner_sigma_px =
        corner_noise_px(observations, fit.used, fit.free_color.size(), fit.parameters);
  return fit;
}

}  // namespace touchtrace
