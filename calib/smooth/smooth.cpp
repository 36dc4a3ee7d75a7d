#include "calib/smooth/smooth.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/robust_smoother.h"
#include "calib/smooth/time_varying_noise.h"
#include "engine/base/error.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

/// With white errors, long tails and overestimated motion noise leave up to a fifth of the variance
/// unexplained; more than this indicates correlated errors.
constexpr double min_correlated_fraction = 0.25;

bool is_valid(const TrackPoint& point) {
  return std::isfinite(point.time_s) && point.position_m.allFinite() && point.sigma_m.allFinite() &&
         point.sigma_m.minCoeff() > 0.0;
}

SmoothStatus check(const Track& track) {
  if (track.empty()) return SmoothStatus::no_samples;
  if (!std::ranges::all_of(track, is_valid)) return SmoothStatus::not_finite;
  if (!std::ranges::is_sorted(track, {}, &TrackPoint::time_s)) return SmoothStatus::unordered_times;
  return SmoothStatus::converged;
}

/// One trajectory per grid time of the events' distributions. All flights move together, as they
/// are too far apart to interact.
std::vector<Trajectory> trajectories_of(WeightedTrack track, const MotionNoise<double>& noise,
                                        const SmoothOptions& options) {
  if (track.flights.empty()) return {smooth_once(track, noise, options)};
  std::vector<Trajectory> result;
  for (std::size_t k = 0; k < EventTimeDistribution::count; ++k) {
    for (auto& flight : track.flights) {
      flight.release_s = flight.release_distribution.time_s[k];
      flight.landing_s = flight.landing_distribution.time_s[k];
    }
    result.push_back(smooth_once(track, noise, options));
  }
  return result;
}

/// The track without estimates that depend on later measurements.
WeightedTrack causal_track(const WeightedTrack& track) {
  return {track.points, std::vector<double>(track.points.size(), 1.0), {}};
}

/// Variance factors at the estimated event times.
VarianceFactors factors_of(const WeightedTrack& track, const SmoothedTrack& smoothed,
                           const MotionNoise<double>& noise, const SmoothOptions& options) {
  VarianceFactors factors;
  const double expected_mean_square = options.robust ? robust_variance_ratio : 1.0;
  if (track.flights.empty())
    factors.add(track, smoothed.trajectories.front(), expected_mean_square);
  else
    factors.add(track, smooth_once(track, noise, options), expected_mean_square);
  return factors;
}

SmoothedTrack finish(WeightedTrack track, const SmoothedTracks& all, const SmoothOptions& options) {
  SmoothedTrack result;
  const bool has_weights = !options.robust || estimate_weights(track, all.noise, options);
  estimate_event_distributions(track, all.noise, options);
  result.trajectories = trajectories_of(track, all.noise, options);
  result.filter = smooth_once(causal_track(track), all.causal_noise, options);
  if (!has_weights || !result.filter.is_finite() ||
      !std::ranges::all_of(result.trajectories, &Trajectory::is_finite)) {
    result.status = SmoothStatus::not_converged;
    return result;
  }
  result.status = SmoothStatus::converged;
  if (options.estimate_noise) result.factors = factors_of(track, result, all.noise, options);
  result.flights = std::move(track.flights);
  result.weights = std::move(track.weights);
  return result;
}

/// Estimates flights, dropping implausible ones, then weights.
void estimate_flights_and_weights(std::vector<WeightedTrack>& tracks,
                                  const MotionNoise<double>& noise, const SmoothOptions& options) {
  parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
    auto& track = tracks[i];
    track.flights = estimate_flights(track, noise, options, ImplausibleFlights::drop);
    if (options.robust) estimate_weights(track, noise, options);
  });
}

/// Estimates time-varying process noise, if it predicts held-out measurements better.
MotionNoise<double> with_time_varying_noise(std::vector<WeightedTrack>& tracks,
                                            MotionNoise<double> noise,
                                            const SmoothOptions& options) {
  const auto fraction = select_prior_jerk_fraction(tracks, noise, options);
  if (!fraction) {
    if (options.robust) noise.measurement_scale /= std::sqrt(robust_variance_ratio);
    return noise;
  }
  noise.prior_jerk_fraction = *fraction;
  for (int round = 0; round < 2; ++round) {
    estimate_jerk_covariances(tracks, noise, options, enough_iterations);
    estimate_flights_and_weights(tracks, noise, options);
  }
  return noise;
}

/// Adds correlated errors if white ones leave much of the tracks' stated variance unexplained. The
/// innovations cannot identify them: in their frequency band a hand's motion is a hundred times
/// stronger.
MotionNoise<double> with_correlated_errors(std::vector<WeightedTrack>& tracks,
                                           MotionNoise<double> noise,
                                           const SmoothOptions& options) {
  if (noise.unexplained_variance_fraction() < min_correlated_fraction) return noise;
  noise.correlated_scale = std::sqrt(noise.unexplained_variance_fraction());
  if (!tracks.front().jerk_covariance.empty()) {
    estimate_jerk_covariances(tracks, noise, options, few_iterations);
    noise.correlated_scale = 0.0;
    noise.correlated_scale = std::sqrt(noise.unexplained_variance_fraction());
  }
  estimate_flights_and_weights(tracks, noise, options);
  return noise;
}

/// Alternates between flights, noise and weights. Flights come first, because noise would
/// compensate for wrong event times, and are dropped only once there is noise to judge them by.
/// Time-varying noise and correlated errors come last, and only if the constant noise could be
/// estimated.
MotionNoise<double> estimate_noise(std::vector<WeightedTrack>& tracks,
                                   const SmoothOptions& options) {
  auto noise = options.noise;
  bool is_estimated = false;
  parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
    tracks[i].flights = estimate_flights(tracks[i], noise, options, ImplausibleFlights::keep);
  });
  for (int round = 0; round < 2; ++round) {
    if (options.estimate_noise) {
      const auto estimate = maximum_likelihood_noise(tracks, options, ContactModel::white_jerk);
      noise = estimate.value_or(noise), is_estimated = estimate.has_value();
    }
    estimate_flights_and_weights(tracks, noise, options);
  }
  if (!is_estimated) return noise;
  return with_correlated_errors(tracks, with_time_varying_noise(tracks, noise, options), options);
}

/// Noise of the causal filters, which ignore flights. They extrapolate, where white-noise jerk lets
/// the acceleration grow without bound, so their velocity is a damped oscillator.
MotionNoise<double> estimate_causal_noise(std::vector<WeightedTrack> tracks,
                                          const MotionNoise<double>& noise,
                                          const SmoothOptions& options) {
  if (!options.estimate_noise) return noise;
  for (auto& track : tracks) track.flights.clear();
  return maximum_likelihood_noise(tracks, options, ContactModel::damped_oscillator).value_or(noise);
}

void pool_factors(std::vector<SmoothedTrack>& tracks) {
  VarianceFactors pooled;
  for (const auto& track : tracks) pooled.add(track.factors);
  for (auto& track : tracks) track.factors = pooled;
}

}  // namespace

SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options) {
  if (!flights.empty() && flights.size() != tracks.size())
    throw usage_error(
        fmt::format("{} lists of flights for {} tracks", flights.size(), tracks.size()),
        "pass one list per track, or none at all");
  SmoothedTracks result;
  result.tracks.resize(tracks.size());
  std::vector<WeightedTrack> usable;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    result.tracks[i].status = check(tracks[i]);
    if (result.tracks[i].status != SmoothStatus::converged) continue;
    usable.push_back({tracks[i], std::vector<double>(tracks[i].size(), 1.0),
                      flights.empty() ? std::vector<Flight>{} : flights[i]});
    index.push_back(i);
  }
  result.noise = estimate_noise(usable, options);
  result.causal_noise = estimate_causal_noise(usable, result.noise, options);
  parallel_for(usable.size(), options.num_threads, [&](std::size_t k) {
    result.tracks[index[k]] = finish(std::move(usable[k]), result, options);
  });
  pool_factors(result.tracks);
  return result;
}

SmoothedTrack smooth(const Track& track, const SmoothOptions& options) {
  return smooth(std::vector<Track>{track}, {}, options).tracks.front();
}

}  // namespace touchtrace
