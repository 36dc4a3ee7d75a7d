#include "calib/smooth/robust_smoother.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchtrace {
namespace {

constexpr double cauchy_scale = 4.0, weight_tolerance = 1e-4;
constexpr int max_passes = 1000;

}  // namespace

Trajectory smooth_once(const WeightedTrack& track, const MotionNoise& noise,
                       const SmoothOptions& options) {
  return {track, noise, options.gravity_m_per_s2};
}

double cauchy_loss(double squared_residual) {
  return cauchy_scale * cauchy_scale * std::log1p(squared_residual / (cauchy_scale * cauchy_scale));
}

double weight_of(Judgement judgement) { return judgement == Judgement::wrong ? 1e-6 : 1.0; }

double reweight(WeightedTrack& track, const Trajectory& trajectory) {
  double max_change = 0.0;
  const auto predicted = trajectory.predicted_measurements();
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& [position_m, white_variance_m2] = predicted[i];
    const double squared_residual = (position_m - track.points[i].position_m)
                                        .cwiseAbs2()
                                        .cwiseQuotient(white_variance_m2)
                                        .sum();
    const auto judgement = track.judgements.empty() ? Judgement::none : track.judgements[i];
    const double weight = judgement == Judgement::none
                              ? 1.0 / (1.0 + squared_residual / (cauchy_scale * cauchy_scale))
                              : weight_of(judgement);
    max_change = std::max(max_change, std::abs(weight - std::exchange(track.weights[i], weight)));
  }
  return max_change;
}

bool estimate_weights(WeightedTrack& track, const MotionNoise& noise,
                      const SmoothOptions& options) {
  for (int i = 0; i < max_passes; ++i)
    if (reweight(track, smooth_once(track, noise, options)) < weight_tolerance) return true;
  return false;
}

}  // namespace touchtrace
