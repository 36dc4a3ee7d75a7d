#include "calib/smooth/smooth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
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

/// The flights with every release moved by `release` and every landing by `landing` deviations.
std::vector<Flight> moved(std::vector<Flight> flights, double release, double landing) {
  for (auto& flight : flights) {
    flight.release_s += release * flight.release_sigma_s;
    flight.landing_s += landing * flight.landing_sigma_s;
  }
  return flights;
}

/// Third-degree cubature over the event times: flights are far enough apart to be moved all at
/// once.
std::vector<Trajectory> trajectories_of(WeightedTrack track, const MotionNoise<double>& noise,
                                        const SmoothOptions& options) {
  if (track.flights.empty()) return {pass(track, noise, options)};
  std::vector<Trajectory> result;
  const auto flights = track.flights;
  const double d = std::numbers::sqrt2;
  for (const auto& [release, landing] : {std::pair{d, 0.0}, {-d, 0.0}, {0.0, d}, {0.0, -d}}) {
    track.flights = moved(flights, release, landing);
    result.push_back(pass(track, noise, options));
  }
  return result;
}

/// The track before anything of its later part was used.
WeightedTrack blind(const WeightedTrack& track) {
  return {track.points, std::vector<double>(track.points.size(), 1.0), {}};
}

SmoothedTrack finish(WeightedTrack track, const SmoothedTracks& all, const SmoothOptions& options) {
  SmoothedTrack result;
  result.status = check(track.points);
  if (result.status != SmoothStatus::converged) return result;
  const bool found = !options.robust || find_weights(track, all.noise, options);
  result.trajectories = trajectories_of(track, all.noise, options);
  result.filter = pass(blind(track), all.causal_noise, options);
  if (!found || !result.filter.finite() ||
      !std::ranges::all_of(result.trajectories, &Trajectory::finite)) {
    result.status = SmoothStatus::not_converged;
    return result;
  }
  result.flights = std::move(track.flights);
  result.weights = std::move(track.weights);
  return result;
}

std::vector<WeightedTrack> usable(const std::vector<WeightedTrack>& tracks) {
  std::vector<WeightedTrack> result;
  std::ranges::copy_if(tracks, std::back_inserter(result), [](const WeightedTrack& track) {
    return check(track.points) == SmoothStatus::converged;
  });
  return result;
}

/// Noise, weights and event times in turn; each is found given the others, twice.
MotionNoise<double> find_noise(std::vector<WeightedTrack>& tracks, const SmoothOptions& options) {
  auto noise = options.noise;
  for (int round = 0; round < 2; ++round) {
    if (options.fit_noise)
      noise = most_likely_noise(usable(tracks), options, TouchedMotion::white_jerk).value_or(noise);
    for (auto& track : tracks) {
      if (check(track.points) != SmoothStatus::converged) continue;
      track.flights = most_likely_flights(track, noise, options);
      if (options.robust) find_weights(track, noise, options);
    }
  }
  return noise;
}

/// As find_noise, of filters that know of no flights. They extrapolate, and the acceleration that
/// white noise on jerk lets grow without bounds would throw them off: theirs swings.
MotionNoise<double> find_causal_noise(const std::vector<WeightedTrack>& tracks,
                                      const MotionNoise<double>& noise,
                                      const SmoothOptions& options) {
  if (!options.fit_noise) return noise;
  auto without_flights = usable(tracks);
  for (auto& track : without_flights) track.flights.clear();
  return most_likely_noise(without_flights, options, TouchedMotion::swinging).value_or(noise);
}

}  // namespace

SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options) {
  std::vector<WeightedTrack> weighted;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    weighted.push_back({tracks[i], std::vector<double>(tracks[i].size(), 1.0), flights[i]});
  SmoothedTracks result;
  result.noise = find_noise(weighted, options);
  result.causal_noise = find_causal_noise(weighted, result.noise, options);
  for (auto& track : weighted) result.tracks.push_back(finish(std::move(track), result, options));
  return result;
}

SmoothedTrack smooth(const Track& track, const SmoothOptions& options) {
  return smooth(std::vector<Track>{track}, {{}}, options).tracks.front();
}

}  // namespace touchtrace
