#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/frames_ahead.h"
#include "pipeline/label/scene_model.h"
#include "pipeline/label/target.h"

namespace touchtrace::label {

/// One body in one camera frame.
struct Observation {
  bool found = false;
  bool follows_hand = false;  ///< the object was not seen: it is where the hand carries it
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(),
                  sigma_m = Eigen::Vector3d::Zero();  ///< of the body's centre
  PixelBox box;
};

struct ClipTrack {
  std::vector<double> time_s;             ///< [frames]
  std::vector<Observation> hand, object;  ///< [frames]
  double object_middle_sigma_m = 0.0;     ///< deviation of its shape's middle from the object's
  int restarts = 0;                       ///< times a tracker was set on its target anew
};

/// Follows hand and object through a clip. Each has a Kalman filter, with gravity once the object
/// is away from the hand; the tracker looks where the filter predicts; its box is believed if the
/// body's points lie in it within the gate, else the body is looked for by colour and depth within
/// the gate, which grows while it is lost.
ClipTrack follow(const SceneModel& scene, FramesAhead::Reader& frames, const ClipFrames& clip,
                 const std::vector<double>& frame_time_s, const Eigen::Vector3d& gravity_m_per_s2,
                 const TrackerKind& tracker);

}  // namespace touchtrace::label
