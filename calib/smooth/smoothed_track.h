#pragma once

#include <vector>

#include "calib/smooth/trajectory.h"
#include "calib/smooth/variance_factors.h"

namespace touchtrace {

/// What became of a track. Everything but `converged` comes without states.
enum class SmoothStatus { converged, no_samples, not_finite, unordered_times, not_converged };

/// "no samples", ...: for messages.
const char* name_of(SmoothStatus status);

/// A track's motion. Times of release and landing are known only so well: states are the mean over
/// trajectories with other times, as likely as the nearest event's are, and the covariance carries
/// their spread.
struct SmoothedTrack {
  SmoothStatus status = SmoothStatus::no_samples;
  std::vector<Flight>
      flights;  ///< with their times found; those that the data do not support are gone
  std::vector<double> weights;           ///< [points] of the robust loss, 1: fully believed
  std::vector<Trajectory> trajectories;  ///< [LikelyTimes::count], or one if nothing flies
  VarianceFactors factors;               ///< of smoothed covariances; the same for all tracks
  Trajectory filter;  ///< knows neither flights nor weights: those use later frames

  /// From all measurements; outside their time the prior continues the motion. Needs `converged`.
  MotionState smoothed(double time_s) const;
  /// From the measurements up to `time_s` only. Needs `converged`.
  MotionState causal(double time_s) const { return filter.causal(time_s); }

 private:
  MotionState with_likely_times(double time_s) const;
  const LikelyTimes& nearest_event(double time_s) const;
};

}  // namespace touchtrace
