#pragma once

#include <vector>

#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/track/box_tracker.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Tracks hand and object in all usable clips, in parallel: from the box frame to the clip's end
/// and to its beginning. Threads without a clip segment frames for the others. `camera_time_s`
/// [camera frames]: when the depth images were taken. `num_threads` 0: one per core; does not
/// change the result.
std::vector<ClipTrack> track_clips(const SceneModel& scene, const FrameSource& frames,
                                   const std::vector<ClipFrames>& clips,
                                   const std::vector<double>& camera_time_s,
                                   const Eigen::Vector3d& gravity_m_per_s2, const TrackerKind& kind,
                                   int num_threads);

}  // namespace touchtrace::label
