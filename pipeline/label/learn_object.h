#pragma once

#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// Foreground of one frame of a clip.
struct SampledFrame {
  const ClipFrames* clip;
  std::size_t index;
  Surface surface;
  std::optional<Eigen::Vector3d> hand_m = std::nullopt;  ///< set by learn_object
};

/// Learns an object's colours and shape into `model`. Colours come from the boxes in the clips'
/// first frames or, if the hand hides the object there, from what moves near the hand in other
/// frames. An object that no colour separates from the hand enters objects_with_hand_color. Throws
/// data_error if an object's box contains only background or no hand is found.
void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  std::vector<SampledFrame>& samples, int num_threads);

}  // namespace touchtrace::label
