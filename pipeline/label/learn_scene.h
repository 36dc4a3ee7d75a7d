#pragma once

#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// Background from its frames, the band from the torso's depth over the recording, and every object
/// as `learn_object` does.
SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips,
                       int threads);

}  // namespace touchtrace::label
