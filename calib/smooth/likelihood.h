#pragma once

#include <vector>

#include "calib/smooth/scaled_track.h"

namespace touchtrace {

/// Negative log-likelihood of a track's innovations, without its constant. `noise` and `gravity` in
/// the track's units.
double negative_log_likelihood(const ScaledTrack& track, const MotionNoise& noise,
                               const Eigen::Vector3d& gravity);

/// The same with its derivatives with respect to ScaledPoint::log_noise of each point, by the
/// modified Bryson-Frazier recursion: no covariance is inverted (Bierman, Fixed interval smoothing
/// with discrete measurements, 1973).
struct LikelihoodGradient {
  double cost = 0.0;
  std::vector<double> by_log_noise;  ///< [points]
};
LikelihoodGradient likelihood_gradient(const ScaledTrack& track, const MotionNoise& noise,
                                       const Eigen::Vector3d& gravity);

}  // namespace touchtrace
