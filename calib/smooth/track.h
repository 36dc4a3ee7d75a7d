#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace touchtrace {

/// Measured position with the standard deviation of its error along each axis.
struct TrackPoint {
  double time_s;
  Eigen::Vector3d position_m, sigma_m;
};

/// Measurements ordered by time; equal times are allowed.
using Track = std::vector<TrackPoint>;

/// Discrete distribution of a time on an even grid.
template <std::size_t num_times>
struct TimeDistribution {
  static constexpr std::size_t count = num_times;
  std::array<double, count> time_s{}, probability{};  ///< probabilities sum to 1

  double mean_s() const {
    return std::inner_product(time_s.begin(), time_s.end(), probability.begin(), 0.0);
  }
  /// Infinite if all times are equal: nothing is known of the time.
  double sigma_s() const {
    if (time_s.front() == time_s.back()) return std::numeric_limits<double>::infinity();
    const double mean = mean_s();
    double variance = 0.0;
    for (std::size_t i = 0; i < count; ++i)
      variance += probability[i] * (time_s[i] - mean) * (time_s[i] - mean);
    return std::sqrt(variance);
  }
};

/// All zero for a guess. An event outside the track has one time, beyond the track's end.
using EventTimeDistribution = TimeDistribution<9>;

/// Free flight from the end of contact to its next beginning. If the track begins or ends in
/// flight, the release is its first time, the landing later than its last time. A flight that
/// begins when the one before it lands begins with a hit.
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
