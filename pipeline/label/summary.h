#pragma once

#include "pipeline/label/clip_tracker.h"
#include "pipeline/label/states.h"
#include "pipeline/label/timeline.h"

namespace touchtrace::label {

/// Fractions of the camera frames of one or more clips, 0..1.
struct FrameStatistics {
  double hand_lost = 0.0, object_lost = 0.0;  ///< without a position
  double object_follows = 0.0;                ///< hidden object, placed in the hand
};

FrameStatistics frame_statistics(const ClipTrack& track);

/// Contents of Labels::summary that come from the tracks.
nlohmann::json summarize(const SceneModel& scene, const Timeline& timeline,
                         const std::vector<ClipFrames>& clips, const std::vector<ClipTrack>& tracks,
                         const SmoothedBodies& bodies);

}  // namespace touchtrace::label
