#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Maximum-likelihood noise of all tracks, given their flights, weights and process noise curves.
/// Estimated: jerk density, bandwidth and measurement scale; with flights also drag, wander,
/// landing velocities and the jerk density of throws. Weak priors keep parameters that the data do
/// not identify near those of SmoothOptions::noise, a bandwidth near 0.2 rad per measurement. The
/// jerk density has none. The search begins at `start`. Returns nullopt for fewer than 6 points or
/// if it fails.
std::optional<MotionNoise> estimate_noise(const std::vector<WeightedTrack>& tracks,
                                          const MotionNoise& start, const SmoothOptions& options);

/// Sets the tracks' process noise curves to their posterior modes: the logarithm of the noise's
/// variance is a random walk with Cauchy steps of scale 0.12 per 0.1 s.
void estimate_curves(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                     const SmoothOptions& options);

}  // namespace touchtrace
