#pragma once

#include <vector>

#include "calib/smooth/smooth.h"
#include "pipeline/cli/smooth_inputs.h"

namespace touchtrace::cli {

/// Warns of positions that move too fast or are too far from the origin for metres, of a stated
/// standard deviation that differs by orders of magnitude from how neighbouring positions scatter,
/// of repeated positions and times, of times that are hardly seconds, and of long gaps.
void warn_of_implausible(const SmoothInput& input);

/// Warns of named flights that the smoother dropped, or of which it moved the release or the
/// landing by over 60 ms: the motion does not fit free fall.
void warn_of_moved_flights(const TrackFile& file, const std::vector<Flight>& named,
                           const SmoothedTrack& smoothed);

/// Warns if gravity does not have its size on Earth, or if no flight is left in `smoothed` and
/// flights are found with gravity along another axis.
void warn_of_gravity(const Eigen::Vector3d& gravity_m_per_s2,
                     const std::vector<SmoothInput>& inputs, const SmoothedTracks& smoothed);

}  // namespace touchtrace::cli
