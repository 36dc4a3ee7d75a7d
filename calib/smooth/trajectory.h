#pragma once

#include <array>
#include <variant>
#include <vector>

#include "calib/smooth/kalman_state.h"
#include "calib/smooth/scaled_track.h"

namespace touchtrace {

/// Smoothed prediction of a measurement.
struct PredictedMeasurement {
  Eigen::Vector3d position_m;
  Eigen::Vector3d white_variance_m2;  ///< of the measurement's error, not divided by its weight
};

/// Smoothed motion: Kalman filter and Rauch-Tung-Striebel smoother with states at the measurements,
/// O(n). States in between follow exactly from the same prior. Filtered covariances are in Joseph
/// form, smoothed ones are sums of positive semidefinite terms.
class Trajectory {
 public:
  Trajectory() = default;
  /// `track` must not be empty.
  Trajectory(const WeightedTrack& track, const MotionNoise& noise,
             const Eigen::Vector3d& gravity_m_per_s2);

  /// Estimate from all measurements. Outside their time span the prior extrapolates.
  MotionState smoothed(double time_s) const;
  /// Estimate from the measurements up to `time_s`; before the first one as `smoothed`.
  MotionState causal(double time_s) const;
  /// Variance of the measurement nearest to `time_s`, as its track states it.
  const Eigen::Vector3d& stated_variance_m2(double time_s) const;
  /// [points] Smoothed predictions of the measurements.
  std::vector<PredictedMeasurement> predicted_measurements() const;
  /// Whether no number overflowed and all variances are positive.
  bool is_finite() const;

 private:
  template <StateModel model>
  struct Knots {
    using State = AxisState<axis_state_size<model>>;
    using States = std::array<State, 3>;
    MotionPrior<model> prior;
    std::vector<States> filtered, smoothed;
  };

  template <StateModel model>
  Knots<model> solve(const ScaledTrack& track, const MotionNoise& scaled_noise) const;
  template <StateModel model>
  typename Knots<model>::States filtered_at(const Knots<model>& knots, double time) const;
  template <StateModel model>
  typename Knots<model>::States smoothed_at(const Knots<model>& knots, double time) const;
  template <StateModel model>
  typename Knots<model>::States extrapolate_backwards(const Knots<model>& knots, double time) const;
  template <StateModel model>
  MotionState to_metres(const Knots<model>& knots,
                        const typename Knots<model>::States& states) const;
  template <StateModel model>
  PredictedMeasurement predict_measurement(const Knots<model>& knots, std::size_t knot) const;
  double noise_scale_at(double time) const;
  std::size_t knot_before(double time) const;

  MotionUnits units_;
  double measurement_scale_ = 1.0;
  double origin_s_ = 0.0;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero(), gravity_ = Eigen::Vector3d::Zero();
  std::vector<double> times_;
  std::vector<double> noise_scale_;                  ///< [points] of the step before each
  std::vector<Eigen::Vector3d> stated_variance_m2_;  ///< [points]
  std::variant<Knots<StateModel::contact>, Knots<StateModel::with_flights>> knots_;
};

}  // namespace touchtrace
