#pragma once

#include <vector>

#include "calib/smooth/trajectory.h"
#include "pipeline/label/follow.h"

namespace touchtrace::label {

/// Stretches in which the object falls freely, and such in which it is away from where the grip has
/// it.
std::vector<Flight> guess_flights(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2);

/// From one lowest place of the object to the next: of one that always flies, but for hits. Where
/// the first or last place lies 3 cm and 5 deviations above the fall of the two next to it, there
/// was a hit in between.
std::vector<Flight> guess_bounces(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2);

/// Part of all frames in which the object falls freely: the second difference of its place over
/// three frames is gravity's. 0 if there are no three frames in a row.
double falling_part(const std::vector<ClipTrack>& tracks, const Eigen::Vector3d& gravity_m_per_s2);

/// What falls freely in more of the frames is never held: it bounces. In a throw it is a fifth.
inline constexpr double falling_part_of_bounces = 0.5;

}  // namespace touchtrace::label
