#pragma once

#include "pipeline/label/states/states.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Fraction of a clip's camera frames without a position of a body, 0..1.
double lost_fraction(const std::vector<Observation>& observations);

/// Contents of Labels::summary that come from the tracks. Fractions of lost states are those of the
/// flags in `labels`, clips without labels included.
nlohmann::json summarize(const SceneModel& scene, const Timeline& timeline,
                         const std::vector<ClipFrames>& clips, const std::vector<ClipTrack>& tracks,
                         const SmoothedBodies& bodies, const Labels& labels);

}  // namespace touchtrace::label
