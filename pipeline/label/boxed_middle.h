#pragma once

#include <string>
#include <vector>

#include "pipeline/label/follow.h"

namespace touchtrace::label {

/// Deviation [m] along an axis of an object's middle from that of its shape, as the boxes tell that
/// are given in the clips' first frames: they hold all of it, what a hand hides in every frame,
/// too, which has no other witness. The median over the clips that show the object in their first
/// frame and not at the picture's border, which may cut it off; 0 within the accuracy of a drawn
/// box.
double boxed_middle_sigma_m(const Camera& color, const std::string& object,
                            const std::vector<ClipFrames>& clips,
                            const std::vector<ClipTrack>& tracks);

}  // namespace touchtrace::label
