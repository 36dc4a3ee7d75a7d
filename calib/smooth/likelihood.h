#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// What is assumed of a motion in touch.
enum class TouchedMotion { white_jerk, swinging };

/// Jerk density and measurement scale, and of a swinging motion frequency and damping, else density
/// and duration of throwing and the drag in flight, that maximise the likelihood of all
/// innovations, by Ceres. Weak priors (a factor of 10 around the options' values, 1 for the scale,
/// and around a swing of half a radian a frame with a damping of a half) hold what the data do not
/// tell. A track's jerk is left out: one density for all. Nothing if there are fewer than 6 points
/// or the search fails.
std::optional<MotionNoise<double>> most_likely_noise(const std::vector<WeightedTrack>& tracks,
                                                     const SmoothOptions& options,
                                                     TouchedMotion motion);

/// What becomes of flights that explain the data worse than no flight does, by the Bayesian
/// information criterion.
enum class Doubtful { keep, drop };

/// The track's flights with the times that maximise the likelihood (a grid of +-60 ms, then Ceres).
std::vector<Flight> most_likely_flights(const WeightedTrack& track,
                                        const MotionNoise<double>& noise,
                                        const SmoothOptions& options, Doubtful doubtful);

/// Sets which other times the events of the track's flights may have had, each given all others.
void find_likely_times(WeightedTrack& track, const MotionNoise<double>& noise,
                       const SmoothOptions& options);

}  // namespace touchtrace
