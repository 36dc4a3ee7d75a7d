#pragma once

#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Keeps each short contact between two flights, replaces it by a hit (such as a bounce), or merges
/// the two flights: whichever has the smallest Bayesian information criterion. Flights that meet in
/// a hit are merged by the same criterion.
std::vector<Flight> join_flights(const WeightedTrack& track, std::vector<Flight> flights,
                                 const MotionNoise& noise, const SmoothOptions& options);

}  // namespace touchtrace
