#include "calib/smooth/smooth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/smooth/flight_times.h"
#include "calib/smooth/noise_estimate.h"
#include "calib/smooth/robust_smoother.h"
#include "calib/smooth/wrong_points.h"
#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

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

/// One trajectory per grid time of the events' distributions. All events move together: they
/// are too far apart to interact.
std::vector<Trajectory> trajectories_of(WeightedTrack track, const MotionNoise& noise,
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

/// Whether half of the measurements are within 5 stated standard deviations (norm over the axes) of
/// the smoothed motion. If these and the model are right, half are within 1.6.
bool is_consistent(const Track& points, const Trajectory& trajectory) {
  constexpr double max_sigmas = 5.0;
  std::vector<double> squares;
  const auto predicted = trajectory.predicted_measurements();
  for (std::size_t i = 0; i < predicted.size(); ++i)
    squares.push_back((predicted[i].position_m - points[i].position_m)
                          .cwiseQuotient(points[i].sigma_m)
                          .squaredNorm());
  return median(std::move(squares)) < max_sigmas * max_sigmas;
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
  const auto& middle = result.trajectories[result.trajectories.size() / 2];
  result.status = options.estimate_noise && !is_consistent(track.points, middle)
                      ? SmoothStatus::inconsistent
                      : SmoothStatus::converged;
  if (options.estimate_noise)
    result.correlated_variance_fraction = all.noise.correlated_variance_fraction();
  result.flights = std::move(track.flights);
  result.weights = std::move(track.weights);
  return result;
}

void estimate_flights_and_weights(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                                  const SmoothOptions& options, DoubtfulFlights doubtful) {
  parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
    auto& track = tracks[i];
    track.flights = estimate_flights(track, noise, options, doubtful);
    if (options.robust) estimate_weights(track, noise, options);
  });
}

/// Sets `noise` to the maximum-likelihood noise of all tracks. Returns whether there is one.
bool update_noise(const std::vector<WeightedTrack>& tracks, const SmoothOptions& options,
                  MotionNoise& noise) {
  const auto estimate = estimate_noise(tracks, noise, options);
  if (!estimate) return false;
  noise = *estimate;
  if (options.robust) noise.measurement_scale /= std::sqrt(robust_variance_ratio);
  return true;
}

/// Maximum-likelihood noise without flights, which leaves the parameters of flights as they are.
MotionNoise estimate_causal_noise(std::vector<WeightedTrack> tracks, const MotionNoise& noise,
                                  const SmoothOptions& options) {
  if (!options.estimate_noise) return noise;
  for (auto& track : tracks) track.flights.clear(), track.curve = {};
  return estimate_noise(tracks, noise, options).value_or(noise);
}

/// Alternates between flights, noise and weights. Flights are first judged with the noise of tracks
/// without any: one wrong flight, such as two with the catch between them, would make noise so
/// large that it hides the others. The process noise varies with time only once its mean is known.
MotionNoise estimate_motion(std::vector<WeightedTrack>& tracks, const SmoothOptions& options) {
  MotionNoise noise = options.noise;
  if (std::ranges::any_of(tracks, [](const auto& track) { return !track.flights.empty(); })) {
    noise = estimate_causal_noise(tracks, noise, options);
    estimate_flights_and_weights(tracks, noise, options, DoubtfulFlights::keep);
  }
  bool is_estimated = false;
  for (int round = 0; round < 4; ++round) {
    if (round >= 2 && !is_estimated) return noise;
    if (round >= 2) estimate_curves(tracks, noise, options);
    if (options.estimate_noise) is_estimated = update_noise(tracks, options, noise);
    estimate_flights_and_weights(tracks, noise, options, DoubtfulFlights::drop);
  }
  if (options.robust) judge_points(tracks, noise, options);
  estimate_curves(tracks, noise, options);
  return noise;
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
  result.noise = estimate_motion(usable, options);
  result.causal_noise = estimate_causal_noise(usable, result.noise, options);
  parallel_for(usable.size(), options.num_threads, [&](std::size_t k) {
    result.tracks[index[k]] = finish(std::move(usable[k]), result, options);
  });
  return result;
}

SmoothedTrack smooth(const Track& track, const SmoothOptions& options) {
  return smooth(std::vector<Track>{track}, {}, options).tracks.front();
}

}  // namespace touchtrace
