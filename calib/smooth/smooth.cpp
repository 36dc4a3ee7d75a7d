#include "calib/smooth/smooth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/smooth/likelihood.h"

namespace touchtrace {
namespace {

constexpr double cauchy_scale = 4.0, weight_tolerance = 1e-4;
constexpr int most_passes = 100;

bool is_finite(const TrackPoint& point) {
  return std::isfinite(point.time_s) && point.position_m.allFinite() && point.sigma_m.allFinite() &&
         point.sigma_m.minCoeff() > 0.0;
}

SmoothStatus check(const Track& track) {
  if (track.empty()) return SmoothStatus::no_samples;
  if (!std::ranges::all_of(track, is_finite)) return SmoothStatus::not_finite;
  if (!std::ranges::is_sorted(track, {}, &TrackPoint::time_s)) return SmoothStatus::unordered_times;
  return SmoothStatus::converged;
}

Trajectory pass(const WeightedTrack& track, const MotionNoise<double>& noise,
                const SmoothOptions& options) {
  return {track.points,   track.weights, track.flights, noise, options.gravity_m_per_s2,
          options.initial};
}

/// Weights of Cauchy's loss at the residuals of `trajectory`; returns the largest change.
double reweight(WeightedTrack& track, const Trajectory& trajectory, double measurement_scale) {
  double change = 0.0;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& point = track.points[i];
    const Eigen::Vector3d residual =
        (trajectory.smoothed(point.time_s).position_m - point.position_m)
            .cwiseQuotient(measurement_scale * point.sigma_m);
    const double weight = 1.0 / (1.0 + residual.squaredNorm() / (cauchy_scale * cauchy_scale));
    change = std::max(change, std::abs(weight - std::exchange(track.weights[i], weight)));
  }
  return change;
}

/// Gauss-Newton on the robust loss: least squares with new weights until they stay. False if they
/// do not.
bool find_weights(WeightedTrack& track, const MotionNoise<double>& noise,
                  const SmoothOptions& options) {
  for (int i = 0; i < most_passes; ++i)
    if (reweight(track, pass(track, noise, options), noise.measurement_scale) < weight_tolerance)
      return true;
  return false;
}

SmoothedTrack finish(WeightedTrack track, const MotionNoise<double>& noise,
                     const SmoothOptions& options) {
  SmoothedTrack result{check(track.points), {}, track.flights, {}};
  if (result.status != SmoothStatus::converged) return result;
  const bool found = !options.robust || find_weights(track, noise, options);
  auto trajectory = pass(track, noise, options);
  if (!found || !trajectory.finite()) {
    result.status = SmoothStatus::not_converged;
    return result;
  }
  result.trajectory = std::move(trajectory);
  result.weights = std::move(track.weights);
  return result;
}

/// Noise, weights and event times in turn; each is found given the others, twice.
MotionNoise<double> find_noise(std::vector<WeightedTrack>& tracks, const SmoothOptions& options) {
  auto noise = options.noise;
  std::vector<WeightedTrack> usable;
  for (int round = 0; round < 2; ++round) {
    usable.clear();
    std::ranges::copy_if(tracks, std::back_inserter(usable), [](const WeightedTrack& track) {
      return check(track.points) == SmoothStatus::converged;
    });
    if (options.fit_noise) noise = most_likely_noise(usable, options).value_or(noise);
    for (auto& track : tracks) {
      if (check(track.points) != SmoothStatus::converged) continue;
      track.flights = most_likely_flights(track, noise, options);
      if (options.robust) find_weights(track, noise, options);
    }
  }
  return noise;
}

}  // namespace

const char* name_of(SmoothStatus status) {
  switch (status) {
    case SmoothStatus::converged:
      return "converged";
    case SmoothStatus::no_samples:
      return "no samples";
    case SmoothStatus::not_finite:
      return "a time, position or deviation that is not a number";
    case SmoothStatus::unordered_times:
      return "times out of order";
    case SmoothStatus::not_converged:
      return "not converged";
  }
  return "unknown";
}

SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options) {
  std::vector<WeightedTrack> weighted;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    weighted.push_back({tracks[i], std::vector<double>(tracks[i].size(), 1.0), flights[i]});
  SmoothedTracks result{find_noise(weighted, options), {}};
  for (auto& track : weighted)
    result.tracks.push_back(finish(std::move(track), result.noise, options));
  return result;
}

SmoothedTrack smooth(const Track& track, const SmoothOptions& options) {
  return smooth(std::vector<Track>{track}, {{}}, options).tracks.front();
}

}  // namespace touchtrace
