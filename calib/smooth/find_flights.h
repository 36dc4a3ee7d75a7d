#pragma once

#include <vector>

#include "calib/smooth/track.h"

namespace touchtrace {

/// Finds stretches of free flight in a track: initial guesses for smooth(), which estimates their
/// times and drops implausible ones. Times are those of samples. `track` must be ordered by time.
///
/// A window of samples is in flight if three conditions hold: a cubic fits it within the standard
/// deviations (chi-square, p > 0.001); the cubic's acceleration is `gravity_m_per_s2` and its jerk
/// zero (p > 0.001); free fall is 10^5 times as probable as the motion of a hand (Bayes factor).
/// Windows last at least 0.15 s and five samples. They are extended, up to 0.5 s, until the
/// conditions are met or violated. Overlapping windows in flight are one flight; an
/// overlap of up to 50 ms is a hit between two.
std::vector<Flight> find_flights(const Track& track, const Eigen::Vector3d& gravity_m_per_s2);

}  // namespace touchtrace
