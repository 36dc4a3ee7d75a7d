#include "calib/rgbd/color_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/robust_fit.h"
#include "calib/rgbd/verdict.h"
#include "calib/rgbd/view_covariance.h"

namespace touchtrace {
namespace {

/// Rule for a second choice, given the solution of `problem`: corners of a view err together, and a
/// lens with many coefficients may fit the boards and leave the rest of the image unknown.
LensRule rule_given(const BoardProblem& problem, const RgbdParameters& parameters) {
  const double count = num_corner_coordinates(problem.observations, problem.used);
  RgbdCalibration c;
  c.color = color_camera(problem.observations, parameters);
  c.lit = problem.observations.lit;
  c.parameters = parameter_names(problem, parameters.lens);
  const Eigen::MatrixXd independent = covariance(problem, parameters);
  if (independent.size() == 0) return {count};
  const ViewCovariance by_view = view_covariance(problem, parameters, independent);
  c.covariance = by_view.by_views;
  const double unknown_px = projection_sigma_quantile_px(c, judged_image_fraction);
  return {count / std::max(1.0, by_view.inflation * by_view.inflation),
          unknown_px <= good_projection_sigma * problem.observations.width};
}

void take(const LensTrial& trial, ColorFit& fit) {
  fit.chosen = trial.name, fit.parameters = trial.parameters, fit.free_color = trial.free_color;
}

/// Replaces lens and parameters by those that `rule` prefers. Returns false if no trial converged.
bool choose(const LensRule& rule, ColorFit& fit) {
  const auto chosen = choose_lens(fit.trials, rule);
  if (chosen) take(fit.trials[*chosen], fit);
  return chosen.has_value();
}

/// Whether the lens can be inverted in the judged fraction of the image.
bool is_invertible(const BoardObservations& observations, const RgbdParameters& parameters) {
  const Camera camera = color_camera(observations, parameters);
  double lit = 0.0, invertible = 0.0;
  for (int row = 0; row < ImageGrid::rows; ++row)
    for (int column = 0; column < ImageGrid::columns; ++column)
      if (observations.lit(row, column)) {
        lit += 1.0;
        invertible += camera.direction(ImageGrid::pixel(camera.width, camera.height, column, row))
                          .allFinite();
      }
  return invertible >= judged_image_fraction * lit;
}

/// Replaces a lens that cannot be inverted by the best one that can, of the same ideal projection
/// if there is any, unless there is very strong evidence against it.
void prefer_invertible(const BoardObservations& observations, ColorFit& fit) {
  if (is_invertible(observations, fit.parameters)) return;
  const auto rank = [&](std::size_t i) {
    const LensTrial& trial = fit.trials[i];
    return std::pair(is_perspective(trial.parameters.lens) != is_perspective(fit.parameters.lens),
                     trial.bic);
  };
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < fit.trials.size(); ++i)
    if (const LensTrial& trial = fit.trials[i];
        trial.converged() && trial.bic < bic_very_strong_evidence &&
        (!best || rank(i) < rank(*best)) && is_invertible(observations, trial.parameters))
      best = i;
  if (!best) return;
  take(fit.trials[*best], fit);
  make_bic_relative(fit.trials, *best);
}

void solve_for_chosen(const BoardObservations& observations, ColorFit& fit) {
  fit.converged = solve(color_problem(observations, fit), fit.parameters);
  if (fit.converged)
    fit.corner_sigma_px =
        corner_noise_px(observations, fit.used, fit.free_color.size(), fit.parameters);
}

}  // namespace

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

ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names) {
  const RobustFits robust = fit_robustly(observations, usable);
  ColorFit fit;
  if (!std::isfinite(robust.better().typical_rms_px)) return fit;
  fit.used = robust.better().used;
  fit.corner_sigma_px = robust.better().sigma_px;
  BoardProblem problem{observations, fit.used, {}, {}};
  problem.corner_sigma_px = fit.corner_sigma_px;
  std::vector<LensStart> starts;
  for (const LensChoice& choice : lens_choices(names))
    starts.push_back({choice, robust.start_of(choice, observations)});
  fit.trials = fit_lenses(problem, starts);
  if (!choose({num_corner_coordinates(observations, fit.used)}, fit)) return fit;
  choose(rule_given(color_problem(observations, fit), fit.parameters), fit);
  prefer_invertible(observations, fit);
  solve_for_chosen(observations, fit);
  return fit;
}

bool choose_lens_again(const BoardProblem& problem, const RgbdParameters& parameters,
                       ColorFit& fit) {
  std::vector<LensStart> starts;
  std::size_t before = 0;
  for (const LensTrial& trial : fit.trials) {
    if (is_perspective(trial.parameters.lens) != is_perspective(parameters.lens)) continue;
    if (trial.name == fit.chosen) before = starts.size();
    starts.push_back({lens_choice(trial.name), trial.parameters});
    starts.back().parameters.corner_offsets_m = parameters.corner_offsets_m;
  }
  fit.trials = fit_lenses(problem, starts);
  const auto chosen = choose_lens(fit.trials, rule_given(problem, parameters));
  if (!chosen) return false;
  const double needed = is_invertible(problem.observations, parameters) ? bic_very_strong_evidence
                                                                        : bic_positive_evidence;
  if (!(fit.trials[before].bic >= needed)) {
    make_bic_relative(fit.trials, before);
    return false;
  }
  take(fit.trials[*chosen], fit);
  fit.parameters.corner_offsets_m.clear();
  solve_for_chosen(problem.observations, fit);
  return true;
}

}  // namespace touchtrace
