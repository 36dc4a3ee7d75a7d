#include "calib/smooth/smooth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/robust_pass.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

/// Of the variance; where errors are white, long tails and what a motion's noise exaggerates leave
/// up to a fifth.
constexpr double least_correlated_share = 0.25;

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

/// One trajectory for each of the likely times of a flight's events, all flights at once: they are
/// far enough apart.
std::vector<Trajectory> trajectories_of(WeightedTrack track, const MotionNoise<double>& noise,
                                        const SmoothOptions& options) {
  if (track.flights.empty()) return {pass(track, noise, options)};
  std::vector<Trajectory> result;
  for (std::size_t k = 0; k < LikelyTimes::count; ++k) {
    for (auto& flight : track.flights) {
      flight.release_s = flight.likely_releases.time_s[k];
      flight.landing_s = flight.likely_landings.time_s[k];
    }
    result.push_back(pass(track, noise, options));
  }
  return result;
}

/// The track before anything of its later part was used.
WeightedTrack blind(const WeightedTrack& track) {
  return {track.points, std::vector<double>(track.points.size(), 1.0), {}};
}

/// Of the flights as they were found.
VarianceFactors factors_of(const WeightedTrack& track, const SmoothedTrack& smoothed,
                           const MotionNoise<double>& noise, const SmoothOptions& options) {
  VarianceFactors factors;
  const double usual = options.robust ? robust_share : 1.0;
  if (track.flights.empty())
    factors.add(track, smoothed.trajectories.front(), usual);
  else
    factors.add(track, pass(track, noise, options), usual);
  return factors;
}

SmoothedTrack finish(WeightedTrack track, const SmoothedTracks& all, const SmoothOptions& options) {
  SmoothedTrack result;
  const bool found = !options.robust || find_weights(track, all.noise, options);
  find_likely_times(track, all.noise, options);
  result.trajectories = trajectories_of(track, all.noise, options);
  result.filter = pass(blind(track), all.causal_noise, options);
  if (!found || !result.filter.finite() ||
      !std::ranges::all_of(result.trajectories, &Trajectory::finite)) {
    result.status = SmoothStatus::not_converged;
    return result;
  }
  result.status = SmoothStatus::converged;
  if (options.fit_noise) result.factors = factors_of(track, result, all.noise, options);
  result.flights = std::move(track.flights);
  result.weights = std::move(track.weights);
  return result;
}

/// Flights and weights, each given the others and the noise.
void find_flights(std::vector<WeightedTrack>& tracks, const MotionNoise<double>& noise,
                  const SmoothOptions& options) {
  parallel_for(tracks.size(), options.threads, [&](std::size_t i) {
    auto& track = tracks[i];
    track.flights = most_likely_flights(track, noise, options, Doubtful::drop);
    if (options.robust) find_weights(track, noise, options);
  });
}

/// The noise with the course of its jerk, where that foretells measurements better.
MotionNoise<double> with_course(std::vector<WeightedTrack>& tracks, MotionNoise<double> noise,
                                const SmoothOptions& options) {
  const auto share = best_jerk_share(tracks, noise, options);
  if (!share) {
    if (options.robust) noise.measurement_scale /= std::sqrt(robust_share);
    return noise;
  }
  noise.usual_jerk_share = *share;
  for (int round = 0; round < 2; ++round) {
    find_jerk(tracks, noise, options, enough_rounds);
    find_flights(tracks, noise, options);
  }
  return noise;
}

/// The noise with errors that neighbours have in common, if the white ones leave much of the
/// deviations that the tracks state. Innovations cannot tell them: in the band of such errors a
/// hand's motion is a hundred times as strong.
MotionNoise<double> with_correlated_errors(std::vector<WeightedTrack>& tracks,
                                           MotionNoise<double> noise,
                                           const SmoothOptions& options) {
  if (noise.left_share() < least_correlated_share) return noise;
  noise.correlated_scale = std::sqrt(noise.left_share());
  if (!tracks.front().jerk.empty()) {
    find_jerk(tracks, noise, options, few_rounds);
    noise.correlated_scale = 0.0;
    noise.correlated_scale = std::sqrt(noise.left_share());
  }
  find_flights(tracks, noise, options);
  return noise;
}

/// Flights, noise and weights in turn: first the flights, for noise would make up for a wrong guess
/// of their times, and is needed to doubt them; at last, where there was enough to find it, with
/// the course of the jerk.
MotionNoise<double> find_noise(std::vector<WeightedTrack>& tracks, const SmoothOptions& options) {
  auto noise = options.noise;
  bool found = false;
  parallel_for(tracks.size(), options.threads, [&](std::size_t i) {
    tracks[i].flights = most_likely_flights(tracks[i], noise, options, Doubtful::keep);
  });
  for (int round = 0; round < 2; ++round) {
    if (options.fit_noise) {
      const auto likely = most_likely_noise(tracks, options, TouchedMotion::white_jerk);
      noise = likely.value_or(noise), found = likely.has_value();
    }
    find_flights(tracks, noise, options);
  }
  if (!found) return noise;
  return with_correlated_errors(tracks, with_course(tracks, noise, options), options);
}

/// As find_noise, of filters that know of no flights. They extrapolate, and the acceleration that
/// white noise on jerk lets grow without bounds would throw them off: theirs swings.
MotionNoise<double> find_causal_noise(std::vector<WeightedTrack> tracks,
                                      const MotionNoise<double>& noise,
                                      const SmoothOptions& options) {
  if (!options.fit_noise) return noise;
  for (auto& track : tracks) track.flights.clear();
  return most_likely_noise(tracks, options, TouchedMotion::swinging).value_or(noise);
}

/// What all tell together.
void share_factors(std::vector<SmoothedTrack>& tracks) {
  VarianceFactors of_all;
  for (const auto& track : tracks) of_all.add(track.factors);
  for (auto& track : tracks) track.factors = of_all;
}

}  // namespace

SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options) {
  SmoothedTracks result;
  result.tracks.resize(tracks.size());
  std::vector<WeightedTrack> usable;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    result.tracks[i].status = check(tracks[i]);
    if (result.tracks[i].status != SmoothStatus::converged) continue;
    usable.push_back({tracks[i], std::vector<double>(tracks[i].size(), 1.0), flights[i]});
    index.push_back(i);
  }
  result.noise = find_noise(usable, options);
  result.causal_noise = find_causal_noise(usable, result.noise, options);
  parallel_for(usable.size(), options.threads, [&](std::size_t k) {
    result.tracks[index[k]] = finish(std::move(usable[k]), result, options);
  });
  share_factors(result.tracks);
  return result;
}

SmoothedTrack smooth(const Track& track, const SmoothOptions& options) {
  return smooth(std::vector<Track>{track}, {{}}, options).tracks.front();
}

}  // namespace touchtrace
