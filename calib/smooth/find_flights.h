#pragma once

#include <vector>

#include "calib/smooth/track.h"

namespace touchtrace {

/// Finds stretches of free flight in a track: initial guesses for smooth(),
/// which estimates their times and drops implausible ones. Times are those of
/// samples.
///
/// A window of samples is in flight if it fits a cubic within its standard
/// deviations (chi-square, p > 0.001), whose acceleration is `gravity_m_per_s2`
/// and whose jerk is zero (p > 0.001), and if this is 10^5 times as probable as
/// by chance in a hand's motion (Bayes factor). Windows last 0.15 s and have
/// five samples at least; they are extended up to 0.5 s until they tell.
/// Overlapping windows in flight are one flight. `track` must be ordered by
/// time.
std::vector<Flight> find_flights(const Track& track, const Eigen::Vector3d& gravity_m_per_s2);

}  // namespace touchtrace
