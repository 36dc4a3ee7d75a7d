#pragma once

#include <vector>

#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/track/frame_prefetcher.h"
#include "pipeline/label/track/observation.h"
#include "pipeline/label/track/target.h"

namespace touchtrace::label {

struct ClipTrack {
  std::vector<double> time_s;             ///< [frames]
  std::vector<Observation> hand, object;  ///< [frames]
  double object_centre_sigma_m = 0.0;     ///< of the shape model's centre about the object's
  int tracker_starts = 0;                 ///< of both image trackers
};

/// Tracks hand and object through one pass. Per body: a Kalman filter predicts (with gravity while
/// the object is away from the hand); the image tracker and a search by class and depth inside the
/// filter's gate find the surface patch; a shape fit gives the centre. Poses of objects that are no
/// spheres are chosen by all frames together.
ClipTrack track_pass(const SceneModel& scene, FramePrefetcher::Reader& frames,
                     const TrackingPass& pass, const std::vector<double>& frame_time_s,
                     const Eigen::Vector3d& gravity_m_per_s2, const TrackerKind& tracker);

/// Track of a clip, in order of time, from its two passes.
ClipTrack join(ClipTrack backward, const ClipTrack& forward);

}  // namespace touchtrace::label
