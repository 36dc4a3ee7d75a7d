#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/base/random.h"
#include "pipeline/scene/base/parameters.h"

namespace touchtrace::scene {

struct MotionState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), velocity_m_per_s = Eigen::Vector3d::Zero(),
                  acceleration_m_per_s2 = Eigen::Vector3d::Zero();
};

inline MotionState at_rest(const Eigen::Vector3d& position_m) {
  return {position_m, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
}

/// Peak acceleration x duration^2 / distance of a minimum-jerk movement from rest to rest.
inline constexpr double minimum_jerk_peak = 5.7735;

/// Progress of a minimum-jerk movement from rest to rest: 0 before it, 1 after it.
double minimum_jerk_progress(double time_s, double start_s, double duration_s);

/// Quintic polynomial between two states: minimum jerk (Flash and Hogan 1985) if both are at rest.
/// After its end it continues with the end's velocity.
class Quintic {
 public:
  Quintic() = default;
  Quintic(const MotionState& from, const MotionState& to, double start_s, double duration_s);

  MotionState at(double time_s) const;
  double duration_s() const { return duration_s_; }
  double end_s() const { return start_s_ + duration_s_; }

 private:
  MotionState from_, to_;
  std::array<Eigen::Vector3d, 3> high_{};  ///< coefficients of t^3, t^4, t^5
  double start_s_ = 0.0, duration_s_ = 0.0;
};

/// Uniform random number of the range.
double draw(RandomStream& random, const Interval& range);
/// Uniform random integer of the range, both ends included.
int draw_integer(RandomStream& random, const Interval& range);
Eigen::Vector3d draw(RandomStream& random, const Box& box);

/// Smooth random function of time with mean 0, standard deviation 1 and frequencies up to
/// `bandwidth_hz`: a sum of sinusoids, so that it does not depend on the step size.
class SmoothNoise {
 public:
  SmoothNoise(RandomStream& random, double bandwidth_hz);
  double at(double time_s) const;

 private:
  static constexpr int terms = 8;
  std::array<double, terms> rate_rad_per_s_, phase_rad_;
};

}  // namespace touchtrace::scene
