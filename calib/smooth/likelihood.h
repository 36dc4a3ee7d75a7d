#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// A track with its weights and flights: what the likelihood of a noise or of an event time needs.
struct WeightedTrack {
  Track points;
  std::vector<double> weights;
  std::vector<Flight> flights;
};

/// Jerk density and measurement scale that maximise the likelihood of all innovations, by Ceres. A
/// weak prior (a factor of 10 around 1) holds the scale where the data do not tell it from motion.
/// Nothing if there are fewer than 6 points or the search fails.
std::optional<MotionNoise<double>> most_likely_noise(const std::vector<WeightedTrack>& tracks,
                                                     const SmoothOptions& options);

/// The track's flights with the times that maximise the likelihood (a grid of +-60 ms, then Ceres),
/// less those that explain the data worse than no flight does, by the Bayesian information
/// criterion.
std::vector<Flight> most_likely_flights(const WeightedTrack& track,
                                        const MotionNoise<double>& noise,
                                        const SmoothOptions& options);

}  // namespace touchtrace
