#include "calib/smooth/robust_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchtrace {
namespace {

constexpr double cauchy_scale = 4.0, weight_tolerance = 1e-4;
constexpr int most_passes = 100;

}  // namespace

Trajectory pass(const WeightedTrack& track, const MotionNoise<double>& noise,
                const SmoothOptions& options) {
  return {track, noise, options.gravity_m_per_s2, options.initial};
}

double cauchy_loss(double square) {
  return cauchy_scale * cauchy_scale * std::log1p(square / (cauchy_scale * cauchy_scale));
}

double reweight(WeightedTrack& track, const Trajectory& trajectory) {
  double change = 0.0;
  const auto foretold = trajectory.foretold();
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& [position_m, variance_m2, own_variance_m2] = foretold[i];
    const double square =
        (position_m - track.points[i].position_m).cwiseAbs2().cwiseQuotient(own_variance_m2).sum();
    const double weight = 1.0 / (1.0 + square / (cauchy_scale * cauchy_scale));
    change = std::max(change, std::abs(weight - std::exchange(track.weights[i], weight)));
  }
  return change;
}

bool find_weights(WeightedTrack& track, const MotionNoise<double>& noise,
                  const SmoothOptions& options) {
  for (int i = 0; i < most_passes; ++i)
    if (reweight(track, pass(track, noise, options)) < weight_tolerance) return true;
  return false;
}

}  // namespace touchtrace
