#pragma once

#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Replaces short contacts between two of `flights` by a hit, such as a bounce, or by nothing, and
/// hits by nothing, where the Bayesian information criterion prefers that.
std::vector<Flight> join_flights(const WeightedTrack& track, std::vector<Flight> flights,
                                 const MotionNoise& noise, const SmoothOptions& options);

}  // namespace touchtrace
