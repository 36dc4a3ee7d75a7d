#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace touchtrace {

/// Measured position with the standard deviation of its error along each axis.
struct TrackPoint {
  double time_s;
  Eigen::Vector3d position_m, sigma_m;
};

/// Measurements ordered by time; equal times are allowed.
using Track = std::vector<TrackPoint>;

/// Discrete distribution of an event's time on an even grid. Sums over it are integrals by the
/// trapezoid rule. All zero for a guess.
struct EventTimeDistribution {
  static constexpr std::size_t count = 9;
  std::array<double, count> time_s{}, probability{};  ///< probabilities sum to 1
};

/// Free flight from the end of contact to its next beginning. A flight that begins when the one
/// before it lands begins with a hit.
struct Flight {
  double release_s, landing_s;
  EventTimeDistribution release_distribution{}, landing_distribution{};
};

/// Position, velocity and acceleration with their joint covariance.
struct MotionState {
  Eigen::Vector3d position_m, velocity_m_per_s, acceleration_m_per_s2;
  Eigen::Matrix<double, 9, 9> covariance;  ///< order: position, velocity, acceleration
};

}  // namespace touchtrace
