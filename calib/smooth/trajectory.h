#pragma once

#include <Eigen/Core>
#include <array>
#include <variant>
#include <vector>

#include "calib/smooth/kalman_state.h"

namespace touchtrace {

/// Measured position with the standard deviation of its total error along each axis.
struct TrackPoint {
  double time_s;
  Eigen::Vector3d position_m, sigma_m;
};

/// Measurements ordered by time; equal times are allowed.
using Track = std::vector<TrackPoint>;

/// Discrete distribution of an event's time on an even grid. Sums over it are integrals by the
/// trapezoid rule. All zero for a guess.
struct EventTimeDistribution {
  static constexpr std::size_t count = 13;
  std::array<double, count> time_s{}, probability{};  ///< probabilities sum to 1
};

/// Free flight from the end of contact to its next beginning. A flight that begins when the one
/// before it lands begins with a hit.
struct Flight {
  double release_s, landing_s;
  EventTimeDistribution release_distribution{}, landing_distribution{};
};

/// Track with its current estimates of weights, flights and process noise.
struct WeightedTrack {
  Track points;
  std::vector<double> weights;  ///< [points] in (0, 1]; variances are divided by them
  std::vector<Flight> flights;
  /// [points] Covariance of the jerk before each point over the noise's density. Empty: identity,
  /// and the axes are filtered independently.
  std::vector<Eigen::Matrix3d> jerk_covariance = {};
};

/// Position, velocity and acceleration with their joint covariance.
struct MotionState {
  Eigen::Vector3d position_m, velocity_m_per_s, acceleration_m_per_s2;
  Eigen::Matrix<double, 9, 9> covariance;  ///< order: position, velocity, acceleration
};

/// Units in which a track's numbers are of order one.
struct MotionUnits {
  double time_s = 1.0, length_m = 1.0;
  Eigen::Vector3d median_sigma = Eigen::Vector3d::Ones();  ///< of each axis, in `length_m`

  /// Time: median spacing of `tracks`. Length: median of the axes' median sigmas.
  static MotionUnits of(const std::vector<Track>& tracks);
  MotionNoise<double> scaled(const MotionNoise<double>& noise) const;
  MotionNoise<double> unscaled(const MotionNoise<double>& noise) const;
  double acceleration() const { return length_m / (time_s * time_s); }
};

/// Prior at the first measurement: standard deviations around zero. Infinite: no prior.
struct InitialMotion {
  double velocity_sigma_m_per_s, acceleration_sigma_m_per_s2;
};

/// Smoothed prediction of a measurement: position plus correlated error.
struct PredictedMeasurement {
  Eigen::Vector3d position_m, variance_m2;
  Eigen::Vector3d white_variance_m2;  ///< of the measurement's white error, not divided by weight
};

struct ScaledTrack;

/// Smoothed motion: Kalman filter and Rauch-Tung-Striebel smoother with states at the measurements,
/// O(n). States in between follow exactly from the same prior. Covariances are sums of positive
/// semidefinite terms, never differences.
class Trajectory {
 public:
  Trajectory() = default;
  /// `track` must not be empty.
  Trajectory(const WeightedTrack& track, const MotionNoise<double>& noise,
             const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial);

  /// Estimate from all measurements. Outside their time span the prior extrapolates.
  MotionState smoothed(double time_s) const;
  /// Estimate from the measurements up to `time_s`; before the first one as `smoothed`.
  MotionState causal(double time_s) const;
  /// [points] Smoothed predictions of the measurements.
  std::vector<PredictedMeasurement> predicted_measurements() const;
  /// [points] Expected covariance of the jerk before each point given all measurements, in the
  /// units of WeightedTrack::jerk_covariance. Zero if unknown: at the first point and in steps that
  /// touch a flight or its throwing phases. Needs a track with jerk covariances.
  std::vector<Eigen::Matrix3d> expected_jerk_covariances() const;
  /// Whether no number overflowed and all variances are positive.
  bool is_finite() const;

 private:
  /// Three independent axes, or one state of three coupled axes.
  template <class State>
  using States = std::array<State, 3 / State::axes>;
  template <class State>
  struct Knots {
    std::vector<States<State>> filtered, smoothed;
  };
  template <ErrorModel errors>
  using IndependentAxis = KalmanState<double, 1, errors>;
  template <ErrorModel errors>
  using CoupledAxes = KalmanState<double, 3, errors>;

  template <ErrorModel errors>
  void solve(const ScaledTrack& points, const InitialMotion& initial);
  template <class State>
  void solve_states(const ScaledTrack& points, const InitialMotion& initial);
  template <class State>
  States<State> predict(const States<State>& states, double from, double to) const;
  template <class State>
  States<State> smooth_step(const States<State>& filtered, double from, double to,
                            const States<State>& later) const;
  template <class State>
  States<State> filtered_at(const Knots<State>& knots, double time) const;
  template <class State>
  States<State> smoothed_at(const Knots<State>& knots, double time) const;
  template <class State>
  States<State> extrapolate_backwards(const Knots<State>& knots, double time) const;
  template <class State>
  MotionState to_metres(const States<State>& states) const;
  template <class State>
  PredictedMeasurement predict_measurement(const States<State>& states, std::size_t knot) const;
  template <class State>
  typename State::AxisMatrix jerk_covariance_at(double time, std::size_t state) const;
  std::size_t knot_before(double time) const;

  MotionUnits units_;
  double origin_s_ = 0.0;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero(), gravity_ = Eigen::Vector3d::Zero();
  MotionPrior<double> prior_{{}, {}};
  std::vector<double> times_;
  std::vector<Eigen::Vector3d> correlated_sigma_, white_variance_;
  std::vector<Eigen::Matrix3d> jerk_covariance_;
  std::variant<Knots<IndependentAxis<ErrorModel::white>>, Knots<CoupledAxes<ErrorModel::white>>,
               Knots<IndependentAxis<ErrorModel::correlated>>,
               Knots<CoupledAxes<ErrorModel::correlated>>>
      knots_;
};

}  // namespace touchtrace
