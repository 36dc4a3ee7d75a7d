#pragma once

#include "pipeline/label/learn/scene_model.h"

namespace touchtrace::label {

/// Learns background, colours and object shapes from frames spread over the usable clips, which
/// have boxes. `use_masks`: hand and object come from the frames' masks instead of background and
/// colours. Sets ClipFrames::problem of clips whose boxes show no hand or object.
SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, std::vector<ClipFrames>& clips, bool use_masks,
                       int num_threads);

}  // namespace touchtrace::label
