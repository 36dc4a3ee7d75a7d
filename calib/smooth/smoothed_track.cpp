#include "calib/smooth/smoothed_track.h"

namespace touchtrace {
namespace {

Eigen::Vector3d axis_of(const MotionState& state, Eigen::Index axis) {
  return {state.position_m[axis], state.velocity_m_per_s[axis], state.acceleration_m_per_s2[axis]};
}

/// The mean of equally likely states, with their spread in its covariance.
MotionState mean_of(const std::vector<MotionState>& states) {
  const double part = 1.0 / static_cast<double>(states.size());
  MotionState mean = states.front();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& state : states) center += part * axis_of(state, axis);
    for (const auto& state : states) {
      const Eigen::Vector3d off = axis_of(state, axis) - center;
      covariance +=
          part * (state.covariance[static_cast<std::size_t>(axis)] + off * off.transpose());
    }
    mean.position_m[axis] = center[0];
    mean.velocity_m_per_s[axis] = center[1];
    mean.acceleration_m_per_s2[axis] = center[2];
    mean.covariance[static_cast<std::size_t>(axis)] = covariance;
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
