#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smoothed_track.h"
#include "pipeline/label/states/timeline.h"

namespace touchtrace::label {

/// Estimates the camera's latency, between 0 and 0.35 s, from catches: the camera sees when a
/// flight ends, and the glove's frames tell between which two readings of the touching rows contact
/// began. Expects one SmoothedTrack per clip, on the clock of `timeline`. nullopt if most flights
/// end with a hit, or if that does not halve the timeline's uncertainty: few catches, a glove that
/// feels none, or an unknown read-out time.
std::optional<LatencyEstimate> latency_from_catches(
    const GloveStream& glove, const Timeline& timeline,
    const std::vector<SmoothedTrack>& object_tracks);

}  // namespace touchtrace::label
