#pragma once

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Whether flights that the Bayesian information criterion neither supports nor rejects are kept.
/// Rejected ones are dropped.
enum class DoubtfulFlights { keep, drop };

/// Returns the track's flights with maximum-likelihood times, by grids of 20 to 0.3 ms, joined by
/// join_flights().
std::vector<Flight> estimate_flights(const WeightedTrack& track, const MotionNoise& noise,
                                     const SmoothOptions& options, DoubtfulFlights doubtful);

/// Sets the time distribution of each event of the track's flights, given the others' likeliest
/// times, and its time to the mean.
void estimate_event_distributions(WeightedTrack& track, const MotionNoise& noise,
                                  const SmoothOptions& options);

}  // namespace touchtrace
