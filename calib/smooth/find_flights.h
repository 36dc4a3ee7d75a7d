#pragma once

#include <vector>

#include "calib/smooth/track.h"

namespace touchtrace {

/// Finds stretches of free flight in a track: initial guesses for smooth(), which estimates their
/// times and drops implausible ones. Times are those of samples.
///
/// A window of samples is in flight if its positions are a parabola of acceleration
/// `gravity_m_per_s2` within their standard deviations (chi-square, p > 0.001), and this explains
/// them better than uniform motion does (likelihood ratio, p < 0.001). Windows last 0.15 s and have
/// five samples at least; they are extended up to 0.4 s until their acceleration is known to
/// 3 m/s^2. Overlapping windows in flight are one flight. Drag is ignored. `track` must be ordered
/// by time.
std::vector<Flight> find_flights(const Track& track, const Eigen::Vector3d& gravity_m_per_s2);

}  // namespace touchtrace
