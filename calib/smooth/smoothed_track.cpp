#include "calib/smooth/smoothed_track.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace touchtrace {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

Vector9 to_vector(const MotionState& state) {
  Vector9 result;
  result << state.position_m, state.velocity_m_per_s, state.acceleration_m_per_s2;
  return result;
}

/// Mean and covariance of a mixture of states.
template <std::size_t count>
MotionState mixture(const std::array<MotionState, count>& states,
                    const std::array<double, count>& probability) {
  Vector9 center = Vector9::Zero();
  for (std::size_t k = 0; k < count; ++k) center += probability[k] * to_vector(states[k]);
  MotionState mean{center.head<3>(), center.segment<3>(3), center.tail<3>(), {}};
  mean.covariance.setZero();
  for (std::size_t k = 0; k < count; ++k) {
    const Vector9 offset = to_vector(states[k]) - center;
    mean.covariance += probability[k] * (states[k].covariance + offset * offset.transpose());
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
      return "time, position or standard deviation not finite, or standard deviation not positive";
    case SmoothStatus::unordered_times:
      return "times out of order";
    case SmoothStatus::not_converged:
      return "not converged";
    case SmoothStatus::inconsistent:
      return "half of the measurements are over 5 standard deviations from the smoothed motion: "
             "these are "
             "too small, or flights are missing";
  }
  return "unknown";
}

const EventTimeDistribution& SmoothedTrack::nearest_event(double time_s) const {
  const EventTimeDistribution* nearest = nullptr;
  double min_distance_s = std::numeric_limits<double>::infinity();
  for (const auto& flight : flights)
    for (const auto& [event_s, distribution] :
         {std::pair{flight.release_s, &flight.release_distribution},
          {flight.landing_s, &flight.landing_distribution}})
      if (const double distance_s = std::abs(event_s - time_s); distance_s < min_distance_s)
        min_distance_s = distance_s, nearest = distribution;
  return *nearest;
}

MotionState SmoothedTrack::average_over_event_times(double time_s) const {
  if (trajectories.size() == 1) return trajectories.front().smoothed(time_s);
  std::array<MotionState, EventTimeDistribution::count> states;
  for (std::size_t k = 0; k < states.size(); ++k) states[k] = trajectories[k].smoothed(time_s);
  return mixture(states, nearest_event(time_s).probability);
}

MotionState SmoothedTrack::smoothed(double time_s) const {
  auto state = average_over_event_times(time_s);
  state.covariance.topLeftCorner<3, 3>().diagonal() +=
      correlated_variance_fraction * trajectories.front().stated_variance_m2(time_s);
  return state;
}

}  // namespace touchtrace
