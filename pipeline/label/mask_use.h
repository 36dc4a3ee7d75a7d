#pragma once

#include <string>
#include <vector>

#include "pipeline/label/scene_model.h"

namespace touchtrace::label {

/// What masks are used for.
enum class MaskUse {
  none,
  hand_only,    ///< the hand where there are masks, which show no object; colours elsewhere
  object_only,  ///< the object where there are masks, which show no hand; colours elsewhere
  some_frames,  ///< hand and object where there are masks; colours elsewhere
  all_frames,   ///< they replace background and colours
};

/// Use of the masks with `--observer`. Warns if they show one body only. `width` [px]: of the
/// masks.
MaskUse choose_masks(const FrameSource& frames, int width, const std::vector<ClipFrames>& clips,
                     const std::string& observer);

}  // namespace touchtrace::label
