#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {

/// One measured position, with the deviation of each axis.
struct TrackPoint {
  double time_s;
  Eigen::Vector3d position_m, sigma_m;
};

/// In order of time; equal times are allowed.
using Track = std::vector<TrackPoint>;

/// Free flight, from the end of contact to its beginning.
struct Flight {
  double release_s, landing_s;
  double release_sigma_s = 0.0, landing_sigma_s = 0.0;  ///< deviations
};

/// Where a body is and how it moves, and how well that is known. Axes are independent.
struct MotionState {
  Eigen::Vector3d position_m, velocity_m_per_s, acceleration_m_per_s2;
  std::array<Eigen::Matrix3d, 3>
      covariance;  ///< of (position, velocity, acceleration), axis by axis

  /// [6, 6] of (position, velocity).
  Eigen::Matrix<double, 6, 6> position_velocity_covariance() const;
};

/// Metres and seconds to the units in which numbers are of order one: t / h, p / s from an origin.
struct MotionUnits {
  double time_s = 1.0, length_m = 1.0;

  /// The median spacing and the median deviation of `tracks`.
  static MotionUnits of(const std::vector<Track>& tracks);
  MotionNoise<double> scaled(const MotionNoise<double>& noise) const;
  MotionNoise<double> unscaled(const MotionNoise<double>& noise) const;
  double acceleration() const { return length_m / (time_s * time_s); }
};

/// What is known of a motion before its first measurement; infinite: nothing.
struct InitialMotion {
  double velocity_m_per_s, acceleration_m_per_s2;  ///< deviations around zero
};

/// A smoothed motion: knots at the measurements, states in between by the same prior, exactly.
/// Filter and Rauch-Tung-Striebel smoother in O(n); covariances are sums of squares, never
/// differences.
class Trajectory {
 public:
  Trajectory() = default;
  /// `weights` [points] in (0, 1] divide the variances. `track` must not be empty.
  Trajectory(const Track& track, const std::vector<double>& weights,
             const std::vector<Flight>& flights, const MotionNoise<double>& noise,
             const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial);

  bool empty() const { return times_.empty(); }
  double first_s() const { return origin_s_ + times_.front() * units_.time_s; }
  double last_s() const { return origin_s_ + times_.back() * units_.time_s; }

  /// From all measurements. Outside [first_s, last_s] the prior continues the motion.
  MotionState smoothed(double time_s) const;
  /// From the measurements up to `time_s` only; before the first: as `smoothed`.
  MotionState causal(double time_s) const;
  /// False if a number overflowed or a covariance is not positive.
  bool finite() const;

 private:
  using Axes = std::array<AxisState<double>, 3>;

  void run_filter(const Track& track, const std::vector<double>& weights,
                  const InitialMotion& initial);
  void run_smoother();
  std::size_t knot_before(double time) const;
  Axes filtered_at(std::size_t knot, double time) const;
  Axes smoothed_at(double time) const;
  MotionState in_metres(const Axes& axes) const;

  MotionUnits units_;
  double origin_s_ = 0.0;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero(), gravity_ = Eigen::Vector3d::Zero();
  MotionPrior<double> prior_{{}, {}};
  std::vector<double> times_;
  std::vector<Axes> filtered_, smoothed_;
};

}  // namespace touchtrace
