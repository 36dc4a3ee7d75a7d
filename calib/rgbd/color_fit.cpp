#include "calib/rgbd/color_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/robust_fit.h"
#include "calib/rgbd/verdict.h"
#include "calib/rgbd/view_covariance.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr int max_trial_iterations = 100;
constexpr double trial_bic_tolerance = 0.001;  ///< error of BIC that trials may leave

double sum_of_squares(const BoardObservations& observations, const std::vector<bool>& used,
                      const RgbdParameters& parameters) {
  double sum = 0.0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view])
      for (const auto& residual : corner_residuals(observations, view, parameters))
        sum += residual.squaredNorm();
  return sum;
}

struct LensFit {
  RgbdParameters parameters;
  std::vector<int> free_color;
  double mean_square = unbounded;  ///< of the residuals [px^2]

  /// Bayesian information criterion for `count` independent residuals.
  double bic(double count) const {
    return count * std::log(mean_square) + static_cast<double>(free_color.size()) * std::log(count);
  }
};

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
const LensFit* find_same_model(const std::vector<LensFit>& earlier, const Lens& lens,
                               const std::vector<int>& free_color) {
  const auto same = std::ranges::find_if(earlier, [&](const LensFit& fitted) {
    return std::isfinite(fitted.mean_square) && fitted.free_color == free_color &&
           is_perspective(fitted.parameters.lens) == is_perspective(lens);
  });
  return same == earlier.end() ? nullptr : &*same;
}

/// Solves for the observable coefficients, starting from `start`, and leaves them in
/// problem.free_color. If `start` fits well, unobservable ones are removed before solving, because
/// they make it diverge.
bool solve_for_observable(BoardProblem& problem, const RgbdParameters& start,
                          const std::vector<LensFit>& earlier, RgbdParameters& parameters,
                          LensTrial& trial) {
  for (;;) {
    throw_if_interrupted();
    if (fits_well(problem, start)) remove_unobservable(problem, start, trial, max_coefficients);
    if (const LensFit* same = find_same_model(earlier, start.lens, problem.free_color)) {
      parameters = same->parameters;
      parameters.lens = start.lens;
      return true;
    }
    parameters = start;
    for (int i = 4; i < max_intrinsics; ++i)
      if (std::ranges::find(problem.free_color, i) == problem.free_color.end())
        parameters.color[static_cast<std::size_t>(i)] = 0.0;
    const bool converged = solve(problem, parameters);
    if (!remove_unobservable(problem, parameters, trial, 1)) return converged;
  }
}

/// `earlier`: fits of other lenses, reused for the same model.
LensFit fit_lens(BoardProblem& problem, const LensChoice& choice, const RgbdParameters& start,
                 const std::vector<LensFit>& earlier, LensTrial& trial) {
  LensFit fitted;
  problem.prior = color_prior(problem.observations, choice.lens);
  problem.free_color = choice.free_color;
  problem.max_iterations = max_trial_iterations;
  const double count = num_corner_coordinates(problem.observations, problem.used);
  problem.cost_tolerance = trial_bic_tolerance / count;
  if (!solve_for_observable(problem, start, earlier, fitted.parameters, trial)) return fitted;
  fitted.free_color = problem.free_color;
  fitted.mean_square =
      std::max(sum_of_squares(problem.observations, problem.used, fitted.parameters) / count,
               min_corner_sigma_px * min_corner_sigma_px);
  return fitted;
}

/// Input of the lens choice other than the fits.
struct ChoiceRule {
  double count;  ///< of independent residuals
  /// Whether the lens that is best for independent corners determines most of the image.
  bool image_known = true;
};

/// BIC gain over the lens `chosen` so far that `fit` needs.
double required_bic_gain(const LensFit& fit, const LensFit* chosen, const ChoiceRule& rule) {
  if (!chosen) return 0.0;
  const bool is_simpler = fit.free_color.size() < chosen->free_color.size();
  return is_perspective(fit.parameters.lens) == is_perspective(chosen->parameters.lens) ||
                 (is_simpler && !rule.image_known)
             ? bic_positive_evidence
             : bic_very_strong_evidence;
}

/// Chooses among fits, and stores BIC relative to the chosen one. Returns false if none converged.
bool choose(const std::vector<LensFit>& fits, const ChoiceRule& rule, ColorFit& result) {
  const double count = rule.count;
  const LensFit* chosen = nullptr;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    result.trials[i].bic = fits[i].bic(count);
    if (!std::isfinite(result.trials[i].bic)) continue;
    if (chosen &&
        fits[i].bic(count) >= chosen->bic(count) - required_bic_gain(fits[i], chosen, rule))
      continue;
    chosen = &fits[i];
    result.chosen = result.trials[i].name;
  }
  if (!chosen) return false;
  for (auto& trial : result.trials) trial.bic -= chosen->bic(count);
  result.parameters = chosen->parameters, result.free_color = chosen->free_color;
  return true;
}

/// Rule for a second choice: corners of a view err together, and a lens with many coefficients may
/// fit the boards and leave the rest of the image unknown.
ChoiceRule rule_given(const BoardObservations& observations, const ColorFit& first, double count) {
  const BoardProblem problem = color_problem(observations, first);
  RgbdCalibration c;
  c.color = color_camera(observations, first.parameters);
  c.lit = observations.lit;
  c.parameters = parameter_names(problem, first.parameters.lens);
  const Eigen::MatrixXd independent = covariance(problem, first.parameters);
  if (independent.size() == 0) return {count};
  const ViewCovariance by_view = view_covariance(problem, first.parameters, independent);
  c.covariance = by_view.by_views;
  const double unknown_px = projection_sigma_quantile_px(c, judged_image_fraction);
  return {count / std::max(1.0, by_view.inflation * by_view.inflation),
          unknown_px <= good_projection_sigma * observations.width};
}

}  // namespace

double num_corner_coordinates(const BoardObservations& observations,
                              const std::vector<bool>& used) {
  std::size_t corners = 0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view]) corners += observations.views[view].corners_px.size();
  return 2.0 * static_cast<double>(corners);
}

Camera color_camera(const BoardObservations& observations, const RgbdParameters& parameters) {
  Camera camera{.width = observations.width, .height = observations.height};
  camera.lens = parameters.lens;
  camera.set_parameters(parameters.color);
  return camera;
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

double rms_of_used_views(const BoardObservations& observations, const std::vector<bool>& used,
                         const RgbdParameters& parameters) {
  const double corners = 0.5 * num_corner_coordinates(observations, used);
  return corners > 0.0 ? std::sqrt(sum_of_squares(observations, used, parameters) / corners) : 0.0;
}

double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters) {
  const double unknowns = static_cast<double>(free_color) + 2.0 +
                          6.0 * static_cast<double>(std::ranges::count(used, true));
  const double freedom = std::max(1.0, num_corner_coordinates(observations, used) - unknowns);
  return std::max(std::sqrt(sum_of_squares(observations, used, parameters) / freedom),
                  min_corner_sigma_px);
}

ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names) {
  const auto choices = lens_choices(names);
  const RobustFits robust = fit_robustly(observations, usable);
  ColorFit fit;
  if (!std::isfinite(robust.better().typical_rms_px)) return fit;
  fit.used = robust.better().used;
  BoardProblem problem{observations, fit.used, {}, {}};
  problem.corner_sigma_px = robust.better().sigma_px;
  fit.corner_sigma_px = problem.corner_sigma_px;
  std::vector<LensFit> fits;
  for (const LensChoice& choice : choices) {
    fit.trials.push_back({lens_name(choice.named), 0.0, {}});
    fits.push_back(
        fit_lens(problem, choice, robust.start_of(choice, observations), fits, fit.trials.back()));
  }
  const double count = num_corner_coordinates(observations, fit.used);
  if (!choose(fits, {count}, fit)) return fit;
  choose(fits, rule_given(observations, fit, count), fit);
  fit.converged = solve(color_problem(observations, fit), fit.parameters);
  if (fit.converged)
    fit.corner_sigma_px =
        corner_noise_px(observations, fit.used, fit.free_color.size(), fit.parameters);
  return fit;
}

}  // namespace touchtrace
