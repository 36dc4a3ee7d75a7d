#pragma once

#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// A sampled frame of a clip and what moves in it.
struct SampledFrame {
  const ClipFrames* clip;
  std::size_t index;
  Surface surface;
  std::optional<Eigen::Vector3d> hand_m = std::nullopt;  ///< as the colours tell
};

/// Colours from the boxes in the clips' first frames or, if they hide the object, from what moves
/// near the hand in others; its shape from all that it shows. An object that no
/// colour tells from the hand is noted as such. Throws data_error if none was seen of it and no
/// hand either.
void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  std::vector<SampledFrame>& samples, int threads);

}  // namespace touchtrace::label
