#include "pipeline/label/states/states.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/smooth/find_flights.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace::label {
namespace {

constexpr double max_sigma_m = 1.0;  // of an extrapolated position; more: nothing is known
/// Rate of a single frame: no other time is near it.
constexpr double single_frame_hz = std::numeric_limits<double>::infinity();
using Observations = std::vector<Observation>;

Track track_of(const std::vector<double>& time_s, const Observations& observations) {
  Track track;
  for (std::size_t i = 0; i < time_s.size(); ++i)
    if (observations[i].found)
      track.push_back({time_s[i], observations[i].position_m, observations[i].sigma_m});
  return track;
}

/// Flags of a label from the nearest camera frame.
std::uint8_t quality(double time_s, const std::vector<double>& frame_time_s,
                     const Observations& observations, double camera_period_s) {
  const auto after = std::ranges::lower_bound(frame_time_s, time_s);
  auto nearest = after == frame_time_s.end() ? after - 1 : after;
  if (nearest != frame_time_s.begin() && time_s - *(nearest - 1) < *nearest - time_s) --nearest;
  const auto& observation = observations[static_cast<std::size_t>(nearest - frame_time_s.begin())];
  std::uint8_t bits = quality_good;
  if (time_s < frame_time_s.front() || time_s > frame_time_s.back()) bits |= quality_gap;
  if (!observation.found || std::abs(*nearest - time_s) > camera_period_s) bits |= quality_lost;
  if (observation.follows_hand) bits |= quality_follows_hand;
  return bits;
}

void append(const Eigen::Vector3d& value, std::vector<double>& to) {
  to.insert(to.end(), value.data(), value.data() + 3);
}

void append_state(const MotionState& state, const MotionState& causal, const ErrorBudget& budget,
                  LabelledBody& body) {
  append(state.position_m, body.position_m);
  append(state.velocity_m_per_s, body.velocity_m_per_s);
  append(causal.position_m, body.causal_position_m);
  append(causal.velocity_m_per_s, body.causal_velocity_m_per_s);
  const StateCovariance covariance = budget.total();
  body.covariance.insert(body.covariance.end(), covariance.data(), covariance.data() + 36);
  for (std::size_t source = 0; source < num_error_sources; ++source)
    body.error_budget_m.push_back(budget.position_sigma_m(source));
}

/// Appends NaN for a clip without a usable track, and for times far from the measured ones.
void append_lost(LabelledBody& body) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto* values : {&body.position_m, &body.velocity_m_per_s, &body.causal_position_m,
                       &body.causal_velocity_m_per_s})
    values->insert(values->end(), 3, nan);
  body.covariance.insert(body.covariance.end(), 36, nan);
  body.error_budget_m.insert(body.error_budget_m.end(), num_error_sources, nan);
  body.quality.push_back(quality_lost | quality_gap);
}

/// `budget_of`: error budget of a smoothed track at the label's time.
template <class BudgetOf>
void append_label(double time_s, const SmoothedTrack& smoothed, const ClipTrack& track,
                  const Observations& observations, double camera_period_s, BudgetOf&& budget_of,
                  LabelledBody& body) {
  if (smoothed.status != SmoothStatus::converged) return append_lost(body);
  const ErrorBudget budget = budget_of(smoothed);
  if (!(budget.total().topLeftCorner<3, 3>().trace() < 3.0 * max_sigma_m * max_sigma_m))
    return append_lost(body);
  append_state(smoothed.smoothed(time_s), smoothed.causal(time_s), budget, body);
  body.quality.push_back(quality(time_s, track.time_s, observations, camera_period_s));
}

/// Appends NaN if the body was not found. `sigma_of`: standard deviations given a smoothed track;
/// without one the observation's own.
template <class SigmaOf>
void append_observation(const Observation& observation, const SmoothedTrack& smoothed,
                        SigmaOf&& sigma_of, std::vector<double>& position,
                        std::vector<double>& sigma) {
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  append(observation.found ? observation.position_m : nan, position);
  if (!observation.found) return append(nan, sigma);
  append(smoothed.status == SmoothStatus::converged ? sigma_of(smoothed) : observation.sigma_m,
         sigma);
}

}  // namespace

SmoothedBodies smooth_bodies(const std::vector<ClipTrack>& tracks,
                             const Eigen::Vector3d& gravity_m_per_s2, Flights search,
                             int num_threads) {
  std::vector<Track> hand, object;
  std::vector<std::vector<Flight>> flights;
  for (const auto& track : tracks) {
    hand.push_back(track_of(track.time_s, track.hand));
    object.push_back(track_of(track.time_s, track.object));
    flights.push_back(search == Flights::find ? find_flights(object.back(), gravity_m_per_s2)
                                              : std::vector<Flight>{});
  }
  SmoothOptions options;
  options.gravity_m_per_s2 = gravity_m_per_s2;
  options.num_threads = num_threads;
  SmoothedBodies bodies;
  parallel_for(2, num_threads, [&](std::size_t body) {
    if (body == 0)
      bodies.object = smooth(object, flights, options);
    else
      bodies.hand = smooth(hand, {}, options);
  });
  return bodies;
}

namespace {

bool raise_sigmas(std::vector<ClipTrack>& tracks, std::vector<Observation> ClipTrack::*body,
                  const char* name, const SmoothedTracks& smoothed) {
  constexpr double min_scale = 2.0, max_raised_m = 0.03;
  const double scale = smoothed.noise.measurement_scale;
  std::vector<double> sigmas_m;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    if (smoothed.tracks[i].status == SmoothStatus::inconsistent)
      for (const auto& observation : tracks[i].*body)
        if (observation.found) sigmas_m.push_back(scale * observation.sigma_m.maxCoeff());
  const double raised_m = median(std::move(sigmas_m));
  if (!(scale > min_scale && raised_m < max_raised_m)) return false;
  Progress::warn(
      fmt::format("positions of the {} scatter {:.0f} times more than their fits state: standard "
                  "deviations are raised to {:.0f} mm; look at them with --preview",
                  name, scale, 1e3 * raised_m));
  for (auto& track : tracks)
    for (auto& observation : track.*body) observation.sigma_m *= scale;
  return true;
}

}  // namespace

bool raise_sigmas(std::vector<ClipTrack>& tracks, const SmoothedBodies& bodies) {
  const bool hand = raise_sigmas(tracks, &ClipTrack::hand, "hand", bodies.hand),
             object = raise_sigmas(tracks, &ClipTrack::object, "object", bodies.object);
  return hand || object;
}

void resample(const std::vector<LabelTime>& times, const std::vector<ClipTrack>& tracks,
              const SmoothedBodies& bodies, const ErrorModel& errors, Labels& labels) {
  std::vector<double> periods_s;
  for (const auto& track : tracks)
    periods_s.push_back(1.0 / rate_of(track.time_s, single_frame_hz));
  for (const auto& at : times) {
    const auto clip = static_cast<std::size_t>(at.clip);
    const auto& track = tracks[clip];
    labels.time_s.push_back(at.time_s);
    labels.clip.push_back(at.clip);
    labels.glove_frame.push_back(at.glove_frame);
    append_label(
        at.time_s, bodies.hand.tracks[clip], track, track.hand, periods_s[clip],
        [&](const SmoothedTrack& smoothed) { return errors.hand(smoothed, at.time_s); },
        labels.hand);
    append_label(
        at.time_s, bodies.object.tracks[clip], track, track.object, periods_s[clip],
        [&](const SmoothedTrack& smoothed) {
          return errors.object(smoothed, at.time_s, track, bodies.object.noise);
        },
        labels.object);
  }
}

RawTrack raw_track(const std::vector<ClipTrack>& tracks, const SmoothedBodies& bodies,
                   const ErrorModel& errors) {
  RawTrack raw;
  for (std::size_t clip = 0; clip < tracks.size(); ++clip)
    for (std::size_t i = 0; i < tracks[clip].time_s.size(); ++i) {
      const auto& track = tracks[clip];
      const auto &hand = track.hand[i], &object = track.object[i];
      raw.time_s.push_back(track.time_s[i]);
      raw.clip.push_back(static_cast<std::int32_t>(clip));
      append_observation(
          hand, bodies.hand.tracks[clip],
          [&](const SmoothedTrack& smoothed) {
            return errors.measured_hand_sigma_m(hand, smoothed, track.time_s[i], bodies.hand.noise);
          },
          raw.hand_m, raw.hand_sigma_m);
      append_observation(
          object, bodies.object.tracks[clip],
          [&](const SmoothedTrack& smoothed) {
            return errors.measured_object_sigma_m(object, smoothed, track.time_s[i], track,
                                                  bodies.object.noise);
          },
          raw.object_m, raw.object_sigma_m);
    }
  return raw;
}

}  // namespace touchtrace::label
