#pragma once

#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// Learns the background from its frames, the depth band in front of the torso from frames of all
/// clips, and every object by learn_object. `num_threads` 0: one per core.
SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips,
                       int num_threads);

}  // namespace touchtrace::label
