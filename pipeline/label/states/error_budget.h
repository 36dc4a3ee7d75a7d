#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "calib/smooth/motion_noise.h"
#include "calib/smooth/smoothed_track.h"
#include "calib/smooth/track.h"
#include "pipeline/label/states/calibration_error.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Sources of a label's error. All are independent of each other.
enum class ErrorSource {
  smoothing,    ///< measurements' white errors and unknown motion between them (calib/smooth)
  correlated,   ///< errors that neighbouring frames share: the visible part changes slowly
  shape,        ///< centre of the shape model about the body's; a hidden object's place in the hand
  calibration,  ///< intrinsics, extrinsics and depth scale: the same in a whole recording
  latency       ///< unknown delay between the streams
};
inline constexpr std::size_t num_error_sources = 5;
inline constexpr std::array<const char*, num_error_sources> error_source_names{
    "smoothing", "correlated", "shape", "calibration", "latency"};

using StateCovariance = Eigen::Matrix<double, 6, 6>;  ///< of (position [m], velocity [m/s])

/// Covariance of one label by source.
struct ErrorBudget {
  std::array<StateCovariance, num_error_sources> covariance;

  ErrorBudget() { covariance.fill(StateCovariance::Zero()); }
  StateCovariance& operator[](ErrorSource source) {
    return covariance[static_cast<std::size_t>(source)];
  }
  StateCovariance total() const {
    StateCovariance sum = StateCovariance::Zero();
    for (const auto& part : covariance) sum += part;
    return sum;
  }
  /// RMS over the axes of a source's standard deviation of the position [m].
  double position_sigma_m(std::size_t source) const {
    return std::sqrt(covariance[source].diagonal().head<3>().mean());
  }
};

/// Assembles error budgets of labels and the standard deviations of measurements.
class ErrorModel {
 public:
  /// `latency_sigma_s`: of the delay between camera and labels.
  ErrorModel(const RgbdCalibration& calibration, double latency_sigma_s)
      : calibration_(calibration), latency_sigma_s_(latency_sigma_s) {}

  /// Budget of the smoothed state at a time. `noise`: of the body's smoother.
  ErrorBudget hand(const SmoothedTrack& smoothed, double time_s) const;
  ErrorBudget object(const SmoothedTrack& smoothed, double time_s, const ClipTrack& track,
                     const MotionNoise& noise) const;

  /// Standard deviations [m] along the axes of the position measured at a time, all sources
  /// included.
  Eigen::Vector3d measured_hand_sigma_m(const Observation& observation,
                                        const SmoothedTrack& smoothed, double time_s,
                                        const MotionNoise& noise) const;
  Eigen::Vector3d measured_object_sigma_m(const Observation& observation,
                                          const SmoothedTrack& smoothed, double time_s,
                                          const ClipTrack& track, const MotionNoise& noise) const;

 private:
  /// Smoothing, calibration and latency.
  ErrorBudget common(const SmoothedTrack& smoothed, double time_s) const;
  /// Covariance that an unknown delay gives to `state`, the smoothed one at `time_s`.
  StateCovariance latency_covariance(const SmoothedTrack& smoothed, double time_s,
                                     const MotionState& state) const;
  Eigen::Vector3d measured_sigma_m(const Observation& observation, const SmoothedTrack& smoothed,
                                   double time_s, const MotionNoise& noise, double shape_m2) const;

  CalibrationError calibration_;
  double latency_sigma_s_;
};

}  // namespace touchtrace::label
