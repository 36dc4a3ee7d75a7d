#pragma once

#include <optional>
#include <span>

#include "pipeline/label/learn/scene_model.h"

namespace touchtrace::label {

/// Camera frames of a clip that have a mask, in increasing order.
std::span<const std::size_t> masked_frames(const FrameSource& frames, const ClipFrames& clip);

/// The only body that up to 64 of the masks show; nullopt: none, or both.
std::optional<MaskValue> only_masked_body(const FrameSource& frames);

/// Whether the mask of a frame of the clip shows both bodies. `width` [px]: of the masks.
bool has_mask_of_both(const FrameSource& frames, int width, const ClipFrames& clip);

/// Sets boxes and box frame of a clip from the masks of one frame: of those that show at least half
/// as much of both bodies as the best one, the frame in which the boxes are nearest to each other.
/// A body's visible part is its number of pixels over the median of all frames. Without a frame
/// that shows both bodies nothing changes.
void set_mask_boxes(const FrameSource& frames, int width, ClipFrames& clip);

}  // namespace touchtrace::label
