#pragma once

#include <cstdint>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// A motion that is known exactly, at 1 kHz from time 0: for tests and figures.
struct SyntheticMotion {
  static constexpr double step_s = 1e-3;

  std::vector<Eigen::Vector3d> position_m, velocity_m_per_s;
  std::vector<Flight> flights;  ///< exact times

  double seconds() const { return step_s * static_cast<double>(position_m.size() - 1); }
  Eigen::Vector3d position_at(double time_s) const;
  Eigen::Vector3d velocity_at(double time_s) const;
};

/// Minimum-jerk strokes of 4-16 cm to and fro, 0.11-0.45 s each.
SyntheticMotion synthetic_wave(double seconds, std::uint64_t seed);

/// A ball thrown up 10-42 cm along -y and caught at 35-60 % of its speed, every 1.5 s or so.
SyntheticMotion synthetic_throw(double seconds, std::uint64_t seed);

/// A ball of 2.7 g that is hit up 12-42 cm again and again, within reach.
SyntheticMotion synthetic_pingpong(double seconds, std::uint64_t seed);

/// `motion` as a camera of `rate_hz` measures it, with white noise of `sigma_m`.
Track measure(const SyntheticMotion& motion, double rate_hz, double sigma_m, std::uint64_t seed);

/// `track` in other units, of which a metre has `meters` and a second `seconds`, from `origin_s`
/// on.
Track rescaled(const Track& track, double meters, double seconds, double origin_s);

}  // namespace touchtrace
