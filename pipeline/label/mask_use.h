#pragma once

#include <string>
#include <vector>

#include "pipeline/label/learn/scene_model.h"

namespace touchtrace::label {

/// What masks are used for.
enum class MaskUse {
  none,
  hand_only,    ///< masks show the hand only: it is taken from them; colours for all else
  object_only,  ///< masks show the object only: it is taken from them; colours for all else
  some_frames,  ///< hand and object are taken from masks where there are some; colours elsewhere
  all_frames,   ///< masks in all frames, without background and colours
};

/// For a summary: "masks", "depth-color", or "depth-color and masks".
const char* name_of(MaskUse use);

/// Use of the masks with `--observer`. Warns if they show one body only. `width` [px]: of the
/// masks.
MaskUse choose_masks(const FrameSource& frames, int width, const std::vector<ClipFrames>& clips,
                     const std::string& observer);

}  // namespace touchtrace::label
