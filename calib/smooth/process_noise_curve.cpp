#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/minimize.h"
#include "calib/smooth/noise_estimate.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

/// Spacing of the knots, unless measurements are so rare that fewer than `min_points_per_knot`
/// would lie between them.
constexpr double knot_spacing_s = 0.1, min_points_per_knot = 2.0;
/// Prior of the logarithm: steps from knot to knot have a Cauchy distribution, mostly constant with
/// jumps where a strike begins and ends, and the value is near 0. Chosen on recorded motion of
/// hands and tools: Gaussian steps of 0.35 per 0.25 s took strikes for outliers and stated half of
/// the velocities' variance in bursts; without the pull to 0 the variance in rests is too small.
constexpr double step_scale = 0.12, value_weight = 0.1;
constexpr int max_iterations = 60;
constexpr double knots_around_pause = 5.0;

/// Gaps between measurements, less a few knots on either side.
std::vector<ProcessNoiseCurve::Pause> pauses_of(const Track& points, double spacing_s) {
  const double margin_s = knots_around_pause * spacing_s;
  std::vector<ProcessNoiseCurve::Pause> pauses;
  double before_s = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length_s = points[i].time_s - points[i - 1].time_s - 2.0 * margin_s;
    if (length_s <= 0.0) continue;
    pauses.push_back({points[i - 1].time_s + margin_s, length_s, before_s});
    before_s += length_s;
  }
  return pauses;
}

ProcessNoiseCurve constant_curve(const Track& points) {
  ProcessNoiseCurve curve;
  curve.start_s = points.front().time_s;
  curve.knot_spacing_s =
      std::max(knot_spacing_s, min_points_per_knot * MotionUnits::of({points}).time_s);
  curve.pauses = pauses_of(points, curve.knot_spacing_s);
  const double elapsed_s = curve.elapsed_s(points.back().time_s);
  const auto num_knots = static_cast<std::size_t>(std::ceil(elapsed_s / curve.knot_spacing_s)) + 1;
  curve.log_variance.resize(std::max<std::size_t>(num_knots, 2), 0.0);
  return curve;
}

/// Negative logarithm of the curve's prior. Adds its derivatives to `gradient`.
double prior_cost(const ProcessNoiseCurve& curve, std::vector<double>& gradient) {
  const auto& values = curve.log_variance;
  double cost = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    cost += 0.5 * value_weight * values[i] * values[i];
    gradient[i] += value_weight * values[i];
  }
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    cost += std::log1p(std::pow(step / step_scale, 2));
    const double slope = 2.0 * step / (step_scale * step_scale + step * step);
    gradient[i] += slope, gradient[i - 1] -= slope;
  }
  return cost;
}

/// Chain rule from the steps' process noise to the curve's knots. Adds to `gradient`.
void add_to_knots(const WeightedTrack& track, const std::vector<double>& by_log_noise,
                  std::vector<double>& gradient) {
  double previous_s = track.points.front().time_s;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const double time_s = track.points[i].time_s;
    const auto [knot, part] = track.curve.position(std::midpoint(previous_s, time_s));
    gradient[knot] += (1.0 - part) * by_log_noise[i];
    gradient[knot + 1] += part * by_log_noise[i];
    previous_s = time_s;
  }
}

}  // namespace

double estimate_curve(WeightedTrack& track, const MotionNoise& noise,
                      const SmoothOptions& options) {
  const auto units = MotionUnits::of({track.points});
  const auto scaled_noise = units.scaled(noise);
  const Eigen::Vector3d gravity = options.gravity_m_per_s2 / units.acceleration();
  auto& curve = track.curve;
  if (curve.log_variance.empty()) curve = constant_curve(track.points);
  auto best = curve.log_variance;
  const auto evaluate = [&](const double* knots, double* gradient) {
    std::copy_n(knots, best.size(), curve.log_variance.begin());
    std::vector<double> derivatives(best.size(), 0.0);
    const double cost = prior_cost(curve, derivatives);
    const ScaledTrack scaled(track, units);
    if (!gradient) return cost + negative_log_likelihood(scaled, scaled_noise, gravity);
    const auto likelihood = likelihood_gradient(scaled, scaled_noise, gravity);
    add_to_knots(track, likelihood.by_log_noise, derivatives);
    std::ranges::copy(derivatives, gradient);
    return cost + likelihood.cost;
  };
  minimize(evaluate, best, max_iterations);
  return evaluate(best.data(), nullptr);
}

void estimate_curves(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                     const SmoothOptions& options) {
  parallel_for(tracks.size(), options.num_threads,
               [&](std::size_t i) { estimate_curve(tracks[i], noise, options); });
}

}  // namespace touchtrace
