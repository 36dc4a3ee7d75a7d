#pragma once

#include <vector>

#include "calib/smooth/smoothed_track.h"

namespace touchtrace {

struct SmoothOptions {
  Eigen::Vector3d gravity_m_per_s2{0.0, 9.81, 0.0};  ///< in the tracks' frame
  MotionNoise noise;  ///< initial guess; used as it is unless estimate_noise
  bool estimate_noise = true;
  bool robust = true;   ///< Cauchy loss of the whitened residual, scale 4; else squared
  int num_threads = 0;  ///< over tracks; 0: one per core; does not change the result
};

struct SmoothedTracks {
  MotionNoise noise;         ///< of the smoother
  MotionNoise causal_noise;  ///< of the causal filter, which ignores flights
  std::vector<SmoothedTrack> tracks;
};

/// Smooths the tracks of one body, one track per clip.
/// `tracks`: positions with standard deviations, ordered by time, in an inertial frame.
/// `flights`: per track, release and landing times correct to +-60 ms, or empty: no track has any.
/// Throws usage_error if `flights` is neither empty nor as long as `tracks`.
///
/// Model: in contact the velocity is a Matern process whose variance varies with time; in flight
/// there is gravity and linear drag, and the measured point wanders about the body. Given event
/// times and noise: Kalman filter and Rauch-Tung-Striebel smoother, O(n), iteratively reweighted
/// for the robust loss. Event times (grids) and noise (Ceres) maximise the likelihood of the
/// innovations. Flights that the Bayesian information criterion rejects are dropped. With
/// estimate_noise and 6 samples or more, all tracks share one maximum-likelihood noise. Bad data do
/// not throw: query states only if SmoothedTrack::status is `converged`.
SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options);

/// Smooths one track without flights.
SmoothedTrack smooth(const Track& track, const SmoothOptions& options);

}  // namespace touchtrace
