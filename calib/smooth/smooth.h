#pragma once

#include <limits>
#include <vector>

#include "calib/smooth/smoothed_track.h"

namespace touchtrace {

struct SmoothOptions {
  Eigen::Vector3d gravity_m_per_s2{0.0, 9.81, 0.0};
  InitialMotion initial{std::numeric_limits<double>::infinity(),
                        std::numeric_limits<double>::infinity()};
  MotionNoise<double> noise;
  double release_s = 0.0;  ///< that a release takes, from hardly held to free
  /// Jerk density and measurement scale by the likelihood of the innovations, and where these leave
  /// a quarter of the variances that the tracks state, that is of errors that neighbours have in
  /// common; else as in `noise`.
  bool fit_noise = true;
  /// Cauchy's loss of the whitened distance, c^2 log(1 + r^2 / c^2) with c = 4; else least squares.
  bool robust = true;
  int threads = 0;  ///< tracks worked on at a time, 0: one a core; the result is the same
};

struct SmoothedTracks {
  MotionNoise<double> noise;
  MotionNoise<double> causal_noise;  ///< of the filters, which know of no flights
  std::vector<SmoothedTrack> tracks;
};

/// Smooths the tracks of one body, clip by clip, with one noise for all: white noise on jerk while
/// touched, gravity in `flights` [tracks] (a guess of their times, +-60 ms, or empty). Times of
/// release and landing are variables; where the data speak against a flight it is left out.
///
/// What is nonlinear (event times, process noise) is Ceres'; what is linear given those is one
/// banded Kalman and Rauch-Tung-Striebel pass, and the robust loss a sequence of such passes with
/// new weights. Where the noise is fitted, residuals say by how much its covariances are off
/// (VarianceFactors).
SmoothedTracks smooth(const std::vector<Track>& tracks,
                      const std::vector<std::vector<Flight>>& flights,
                      const SmoothOptions& options);

/// One track without flights.
SmoothedTrack smooth(const Track& track, const SmoothOptions& options);

}  // namespace touchtrace
