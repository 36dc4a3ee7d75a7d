#pragma once

#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// Outcome of smoothing a track. Only `converged` comes with states.
enum class SmoothStatus {
  converged,
  no_samples,
  not_finite,
  unordered_times,
  not_converged,
  inconsistent  ///< the estimated motion misses half of the measurements by over 5 sigma
};

/// Description for messages, such as "no samples".
const char* name_of(SmoothStatus status);

/// Smoothed motion of a track. Release and landing times are uncertain: states are the mean over
/// trajectories with different times, weighted by the time distribution of the nearest event, and
/// their spread is part of the covariance.
struct SmoothedTrack {
  SmoothStatus status = SmoothStatus::no_samples;
  std::vector<Flight> flights;           ///< with estimated times, without the rejected ones
  std::vector<double> weights;           ///< [points] of the robust loss; 1: inlier
  std::vector<Trajectory> trajectories;  ///< [EventTimeDistribution::count]; one without flights
  /// Variance of errors that neighbouring measurements share, which smoothing does not reduce, over
  /// the nearest measurement's. Part of the positions' covariance.
  double correlated_variance_fraction = 0.0;
  Trajectory filter;  ///< causal: without flights, weights and curve, which depend on later samples

  /// Estimate from all measurements. Outside their time span the prior extrapolates. Needs
  /// `converged`.
  MotionState smoothed(double time_s) const;
  /// Estimate from the measurements up to `time_s`. Needs `converged`.
  MotionState causal(double time_s) const { return filter.causal(time_s); }

 private:
  MotionState average_over_event_times(double time_s) const;
  const EventTimeDistribution& nearest_event(double time_s) const;
};

}  // namespace touchtrace
