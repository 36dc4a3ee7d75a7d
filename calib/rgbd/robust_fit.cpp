#include "calib/rgbd/robust_fit.h"

#include <algorithm>
#include <cmath>

#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/initial_guess.h"
#include "calib/rgbd/prior.h"
#include "engine/base/interrupt.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_robust_rounds = 2;
constexpr double poor_rms_px = 1.0;  ///< above it, a lens taken for radtan4 may be a fisheye
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

}  // namespace

const RobustFit& RobustFits::better() const {
  if (!perspective) return *equidistant;
  if (!equidistant) return *perspective;
  return perspective->typical_rms_px <= equidistant->typical_rms_px ? *perspective : *equidistant;
}

RgbdParameters RobustFits::start_of(const Lens& lens) const {
  const RobustFit& own = is_perspective(lens) ? *perspective : *equidistant;
  if (!(own.typical_rms_px > much_worse_ratio * better().typical_rms_px)) return own.parameters;
  RgbdParameters start = better().parameters;
  std::fill(start.color.begin() + 4, start.color.end(), 0.0);
  return start;
}

RobustFits fit_robustly(const BoardObservations& observations, const std::vector<bool>& usable,
                        const std::vector<LensChoice>& choices) {
  RobustFits all;
  for (const LensChoice& choice : choices) {
    auto& kind = is_perspective(choice.lens) ? all.perspective : all.equidistant;
    if (!kind)
      kind = fit_robustly(observations, usable,
                          is_perspective(choice.lens) ? lens_choice("radtan4") : choice);
  }
  if (!all.equidistant && all.perspective->typical_rms_px > poor_rms_px)
    all.equidistant = fit_robustly(observations, usable, lens_choice("fisheye4"));
  return all;
}

}  // namespace touchtrace
