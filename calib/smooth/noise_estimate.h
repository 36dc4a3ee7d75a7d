#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Maximum-likelihood noise of all tracks, given their flights, weights and process noise curves.
/// Estimated: jerk density, bandwidth and measurement scale; with flights also drag, wander,
/// landing velocities and the jerk density of throws. Weak priors keep parameters that the data do
/// not identify near those of SmoothOptions::noise, a bandwidth near 0.2 rad per measurement. That
/// of the jerk density is the weakest. The search begins at `start`. Returns nullopt for fewer than
/// 6 points or if it fails.
std::optional<MotionNoise> estimate_noise(const std::vector<WeightedTrack>& tracks,
                                          const MotionNoise& start, const SmoothOptions& options);

/// Sets a track's process noise curve to its posterior mode: the logarithm of the noise's variance
/// is a random walk with Cauchy steps of scale 0.12 per 0.1 s. Returns the negative logarithm of
/// the posterior there, without its constant.
double estimate_curve(WeightedTrack& track, const MotionNoise& noise, const SmoothOptions& options);
void estimate_curves(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                     const SmoothOptions& options);

}  // namespace touchtrace
