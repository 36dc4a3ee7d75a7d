#include "calib/smooth/smoothed_track.h"

namespace touchtrace {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

Vector9 vector_of(const MotionState& state) {
  Vector9 result;
  result << state.position_m, state.velocity_m_per_s, state.acceleration_m_per_s2;
  return result;
}

/// The mean of equally likely states, with their spread in its covariance.
MotionState mean_of(const std::vector<MotionState>& states) {
  const double part = 1.0 / static_cast<double>(states.size());
  Vector9 center = Vector9::Zero();
  for (const auto& state : states) center += part * vector_of(state);
  MotionState mean{center.head<3>(), center.segment<3>(3), center.tail<3>(), {}};
  mean.covariance.setZero();
  for (const auto& state : states) {
    const Vector9 off = vector_of(state) - center;
    mean.covariance += part * (state.covariance + off * off.transpose());
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

MotionState SmoothedTrack::smoothed(double time_s) const {
  if (trajectories.size() == 1) return trajectories.front().smoothed(time_s);
  std::vector<MotionState> states;
  for (const auto& trajectory : trajectories) states.push_back(trajectory.smoothed(time_s));
  return mean_of(states);
}

}  // namespace touchtrace
