#include "calib/smooth/smoothed_track.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace touchtrace {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

Vector9 vector_of(const MotionState& state) {
  Vector9 result;
  result << state.position_m, state.velocity_m_per_s, state.acceleration_m_per_s2;
  return result;
}

/// The mean of states that are as likely as `parts` say, with their spread in its covariance.
template <std::size_t count>
MotionState mean_of(const std::array<MotionState, count>& states,
                    const std::array<double, count>& parts) {
  Vector9 center = Vector9::Zero();
  for (std::size_t k = 0; k < count; ++k) center += parts[k] * vector_of(states[k]);
  MotionState mean{center.head<3>(), center.segment<3>(3), center.tail<3>(), {}};
  mean.covariance.setZero();
  for (std::size_t k = 0; k < count; ++k) {
    const Vector9 off = vector_of(states[k]) - center;
    mean.covariance += parts[k] * (states[k].covariance + off * off.transpose());
  }
  return mean;
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

const LikelyTimes& SmoothedTrack::nearest_event(double time_s) const {
  const LikelyTimes* nearest = nullptr;
  double least_s = std::numeric_limits<double>::infinity();
  for (const auto& flight : flights)
    for (const auto& [event_s, likely] : {std::pair{flight.release_s, &flight.likely_releases},
                                          {flight.landing_s, &flight.likely_landings}})
      if (const double away_s = std::abs(event_s - time_s); away_s < least_s)
        least_s = away_s, nearest = likely;
  return *nearest;
}

MotionState SmoothedTrack::with_likely_times(double time_s) const {
  if (trajectories.size() == 1) return trajectories.front().smoothed(time_s);
  std::array<MotionState, LikelyTimes::count> states;
  for (std::size_t k = 0; k < states.size(); ++k) states[k] = trajectories[k].smoothed(time_s);
  return mean_of(states, nearest_event(time_s).likelihood);
}

MotionState SmoothedTrack::smoothed(double time_s) const {
  auto state = with_likely_times(time_s);
  state.covariance *= factors.at(flights, time_s);
  return state;
}

}  // namespace touchtrace
