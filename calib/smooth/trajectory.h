#pragma once

#include <Eigen/Core>
#include <array>
#include <variant>
#include <vector>

#include "calib/smooth/body_state.h"

namespace touchtrace {

/// One measured position, with the deviation of each axis, of all its errors together.
struct TrackPoint {
  double time_s;
  Eigen::Vector3d position_m, sigma_m;
};

/// In order of time; equal times are allowed.
using Track = std::vector<TrackPoint>;

/// Times that an event may have had, evenly spaced, and how likely each is: sums over them are
/// integrals by the trapezoid rule. Where only a guess is known nothing is likely.
struct LikelyTimes {
  static constexpr std::size_t count = 13;
  std::array<double, count> time_s{}, likelihood{};  ///< these sum to 1
};

/// Free flight, from the end of contact to its beginning. One that begins when the one before it
/// lands begins with a hit.
struct Flight {
  double release_s, landing_s;
  LikelyTimes likely_releases{}, likely_landings{};
};

/// A track with all that is believed of it.
struct WeightedTrack {
  Track points;
  std::vector<double> weights;  ///< [points] in (0, 1]: they divide the variances
  std::vector<Flight> flights;
  /// [points] Covariance of the jerk up to each point, over the noise's density; empty: the
  /// identity, and axes are independent.
  std::vector<Eigen::Matrix3d> jerk = {};
};

/// Where a body is and how it moves, and how well that is known.
struct MotionState {
  Eigen::Vector3d position_m, velocity_m_per_s, acceleration_m_per_s2;
  /// Of (position, velocity, acceleration), three axes each.
  Eigen::Matrix<double, 9, 9> covariance;

  /// [3, 3] of one axis' (position, velocity, acceleration).
  Eigen::Matrix3d axis_covariance(Eigen::Index axis) const;
};

/// Metres and seconds to the units in which numbers are of order one: t / h, p / s from an origin.
struct MotionUnits {
  double time_s = 1.0, length_m = 1.0;
  Eigen::Vector3d usual_sigma = Eigen::Vector3d::Ones();  ///< of each axis, in such units

  /// The median spacing of `tracks`, and the median deviations of the axes and of these.
  static MotionUnits of(const std::vector<Track>& tracks);
  MotionNoise<double> scaled(const MotionNoise<double>& noise) const;
  MotionNoise<double> unscaled(const MotionNoise<double>& noise) const;
  double acceleration() const { return length_m / (time_s * time_s); }
};

/// What is known of a motion before its first measurement; infinite: nothing.
struct InitialMotion {
  double velocity_m_per_s, acceleration_m_per_s2;  ///< deviations around zero
};

/// A measurement as the others and itself foretell it, correlated errors and all.
struct ForetoldPoint {
  Eigen::Vector3d position_m, variance_m2;
  Eigen::Vector3d own_variance_m2;  ///< of the rest of its error, before its weight divides it
};

struct ScaledTrack;

/// A smoothed motion: knots at the measurements, states in between by the same prior, exactly.
/// Filter and Rauch-Tung-Striebel smoother in O(n); covariances are sums of squares, never
/// differences.
class Trajectory {
 public:
  Trajectory() = default;
  /// `track` must not be empty.
  Trajectory(const WeightedTrack& track, const MotionNoise<double>& noise,
             const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial);

  bool empty() const { return times_.empty(); }
  double first_s() const { return origin_s_ + times_.front() * units_.time_s; }
  double last_s() const { return origin_s_ + times_.back() * units_.time_s; }

  /// From all measurements. Outside [first_s, last_s] the prior continues the motion.
  MotionState smoothed(double time_s) const;
  /// From the measurements up to `time_s` only; before the first: as `smoothed`.
  MotionState causal(double time_s) const;
  /// [points] What each measurement should have been but for the error that no neighbour has.
  std::vector<ForetoldPoint> foretold() const;
  /// [points] The covariance that is to be expected, given all measurements, of the jerk up to
  /// each point, in the units of WeightedTrack::jerk; zero where a flight or nothing says so.
  std::vector<Eigen::Matrix3d> expected_jerk() const;
  /// False if a number overflowed or a covariance is not positive.
  bool finite() const;

 private:
  /// Axes one by one where they are independent, else all together.
  template <class Body>
  using Bodies = std::array<Body, 3 / Body::axes>;
  template <class Body>
  struct Knots {
    std::vector<Bodies<Body>> filtered, smoothed;
  };
  template <Errors errors>
  using Axis = BodyState<double, 1, errors>;
  template <Errors errors>
  using Whole = BodyState<double, 3, errors>;

  template <Errors errors>
  void run(const ScaledTrack& points, const InitialMotion& initial);
  template <class Body>
  void run_bodies(const ScaledTrack& points, const InitialMotion& initial);
  template <class Body>
  Bodies<Body> after(const Bodies<Body>& bodies, double from, double to) const;
  template <class Body>
  Bodies<Body> before(const Bodies<Body>& filtered, double from, double to,
                      const Bodies<Body>& later) const;
  template <class Body>
  Bodies<Body> filtered_at(const Knots<Body>& knots, double time) const;
  template <class Body>
  Bodies<Body> smoothed_at(const Knots<Body>& knots, double time) const;
  template <class Body>
  Bodies<Body> before_the_first(const Knots<Body>& knots, double time) const;
  template <class Body>
  MotionState in_metres(const Bodies<Body>& bodies) const;
  template <class Body>
  ForetoldPoint foretold(const Bodies<Body>& bodies, std::size_t knot) const;
  template <class Body>
  typename Body::Between jerk(double time, std::size_t body) const;
  std::size_t knot_before(double time) const;

  MotionUnits units_;
  double origin_s_ = 0.0;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero(), gravity_ = Eigen::Vector3d::Zero();
  MotionPrior<double> prior_{{}, {}};
  std::vector<double> times_;
  std::vector<Eigen::Vector3d> correlated_sigma_, own_variance_;
  std::vector<Eigen::Matrix3d> jerk_;
  std::variant<Knots<Axis<Errors::white>>, Knots<Whole<Errors::white>>,
               Knots<Axis<Errors::correlated>>, Knots<Whole<Errors::correlated>>>
      knots_;
};

}  // namespace touchtrace
