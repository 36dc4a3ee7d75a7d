#pragma once

#include <vector>

#include "calib/smooth/track.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Initial flights for the smoother: stretches in which the object accelerates like free fall or is
/// farther from the hand than in the grip.
std::vector<Flight> guess_flights(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2);

/// Initial flights of an object that flies except at hits: from one lowest point to the next. A hit
/// is added before the second or after the last but one position if the position beyond is 3 cm and
/// 5 standard deviations above the extrapolated fall of its two neighbours.
std::vector<Flight> guess_bounces(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2);

/// Fraction of frames in free fall: the second difference of the object's position over three
/// frames is gravity, to 3 m/s^2. 0 without three consecutive frames.
double free_fall_fraction(const std::vector<ClipTrack>& tracks,
                          const Eigen::Vector3d& gravity_m_per_s2);

/// An object with a larger free_fall_fraction bounces and is never held; in a throw it is 0.2.
inline constexpr double min_bounce_fraction = 0.5;

}  // namespace touchtrace::label
