#pragma once

#include <string>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Boxes of one clip, drawn in one camera frame.
struct ClipBoxes {
  std::size_t clip = 0, frame = 0;  ///< indices
  PixelBox hand, object;
};

/// Parses "x,y,width,height". Throws usage_error for another text.
PixelBox parse_box(const std::string& text);

/// Throws data_error, with what to do, if the clip or the frame does not exist, the frame is not in
/// the clip, a box is empty or leaves the image, or both boxes are the same.
void require_plausible(const ClipBoxes& boxes, const Recording& recording);

}  // namespace touchtrace
