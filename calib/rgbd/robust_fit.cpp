#include "calib/rgbd/robust_fit.h"

#include <algorithm>
#include <cmath>

#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/initial_guess.h"
#include "calib/rgbd/prior.h"
#include "engine/base/interrupt.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_robust_rounds = 2;
constexpr double robust_fit_tolerance = 1e-5;

std::vector<double> view_rms(const BoardProblem& problem, const RgbdParameters& parameters) {
  std::vector<double> values;
  for (std::size_t view = 0; view < problem.used.size(); ++view)
    values.push_back(rms(corner_residuals(problem.observations, view, parameters)));
  return values;
}

double median_of_selected(const std::vector<double>& values, const std::vector<bool>& selected) {
  std::vector<double> chosen;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (selected[i]) chosen.push_back(values[i]);
  return median(std::move(chosen));
}

RobustFit fit_robustly(const BoardObservations& observations, const std::vector<bool>& usable,
                       const LensChoice& choice) {
  RobustFit result{initial_guess(observations, choice.lens), usable};
  BoardProblem problem{observations, usable, {}, color_prior(observations, choice.lens)};
  problem.cost_tolerance = problem.parameter_tolerance = robust_fit_tolerance;
  solve(problem, result.parameters);  // without distortion, for a better start
  problem.free_color = choice.free_color;
  for (int round = 0; round < num_robust_rounds; ++round) {
    throw_if_interrupted();
    const bool converged = solve(problem, result.parameters);
    const auto values = view_rms(problem, result.parameters);
    const double typical = median_of_selected(values, usable);
    for (std::size_t view = 0; view < values.size(); ++view)
      problem.used[view] = usable[view] && values[view] <= outlier_ratio * typical;
    problem.corner_sigma_px = std::max(typical / std::sqrt(2.0), min_corner_sigma_px);
    result.typical_rms_px =
        converged && std::isfinite(typical) ? typical : std::numeric_limits<double>::infinity();
  }
  result.used = problem.used, result.sigma_px = problem.corner_sigma_px;
  return result;
}

/// Fits the coefficients of another lens to the corners, with the poses of `fit`.
RgbdParameters convert_lens(const RobustFit& fit, const LensChoice& choice,
                            const BoardObservations& observations) {
  RgbdParameters converted = fit.parameters;
  converted.lens = choice.lens;
  std::fill(converted.color.begin() + 4, converted.color.end(), 0.0);
  BoardProblem problem{
      observations, fit.used, {}, color_prior(observations, choice.lens), choice.free_color};
  problem.corner_sigma_px = fit.sigma_px;
  problem.estimated = Estimated::color_camera;
  solve(problem, converted);
  return converted;
}

}  // namespace

const RobustFit& RobustFits::better() const {
  return perspective.typical_rms_px <= equidistant.typical_rms_px ? perspective : equidistant;
}

RgbdParameters RobustFits::start_of(const LensChoice& choice,
                                    const BoardObservations& observations) const {
  const RobustFit& own = is_perspective(choice.lens) ? perspective : equidistant;
  if (own.typical_rms_px > much_worse_ratio * better().typical_rms_px)
    return convert_lens(better(), choice, observations);
  RgbdParameters start = own.parameters;
  start.lens = choice.lens;
  return start;
}

RobustFits fit_robustly(const BoardObservations& observations, const std::vector<bool>& usable) {
  return {fit_robustly(observations, usable, lens_choice("radtan4")),
          fit_robustly(observations, usable, lens_choice("fisheye4"))};
}

}  // namespace touchtrace
