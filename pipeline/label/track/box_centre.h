#pragma once

#include <string>
#include <vector>

#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Standard deviation [m], per axis, of an object's centre about its shape model's, from the boxes
/// in the clips' box frames. Boxes contain the whole object, so they alone show what a hand hides
/// in every frame. Median over the clips whose box frame shows the object and whose box was drawn
/// and is not at the image border; 0 within the accuracy of a drawn box.
double box_centre_sigma_m(const Camera& color, const std::string& object,
                          const std::vector<ClipFrames>& clips,
                          const std::vector<ClipTrack>& tracks);

}  // namespace touchtrace::label
