#pragma once

#include <cstdint>
#include <vector>

#include "calib/smooth/track.h"

namespace touchtrace {

/// Exactly known motion at 1 kHz from time 0.
struct SyntheticMotion {
  static constexpr double step_s = 1e-3;

  std::vector<Eigen::Vector3d> position_m, velocity_m_per_s;
  std::vector<Flight> flights;  ///< exact times

  double seconds() const { return step_s * static_cast<double>(position_m.size() - 1); }
  Eigen::Vector3d position_at(double time_s) const;
  Eigen::Vector3d velocity_at(double time_s) const;
};

/// Back-and-forth minimum-jerk strokes of 4-16 cm, 0.11-0.45 s each.
SyntheticMotion synthetic_wave(double seconds, std::uint64_t seed);

/// Ball thrown up 10-42 cm along -y about every 1.5 s; a catch keeps 35-60 % of its speed.
SyntheticMotion synthetic_throw(double seconds, std::uint64_t seed);

/// Ball of 2.7 g hit up 12-42 cm repeatedly, within reach.
SyntheticMotion synthetic_pingpong(double seconds, std::uint64_t seed);

/// Positions of `motion` at `rate_hz` with white noise of standard deviation `sigma_m`.
Track measure(const SyntheticMotion& motion, double rate_hz, double sigma_m, std::uint64_t seed);

/// `track` in units of 1 m / `meters` and 1 s / `seconds`, its time shifted by `origin_s`.
Track rescaled(const Track& track, double meters, double seconds, double origin_s);

}  // namespace touchtrace
