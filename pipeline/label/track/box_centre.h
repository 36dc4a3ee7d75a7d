#pragma once

#include <string>
#include <vector>

#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Whether the object's centre, as measured in the clip's box frame, is outside its drawn box: what
/// was found is another body, or more than the body.
bool is_outside_box(const Camera& color, const ClipFrames& clip, const ClipTrack& track);

/// Standard deviation [m], per axis, of an object's centre about its shape model's, from the boxes
/// in the clips' box frames. Boxes contain the whole object, so they alone show what a hand hides
/// in every frame. Median over the clips whose box frame shows the object and whose box was drawn
/// and is not at the image border; 0 within the accuracy of a drawn box.
double box_centre_sigma_m(const Camera& color, const std::string& object,
                          const std::vector<ClipFrames>& clips,
                          const std::vector<ClipTrack>& tracks);

}  // namespace touchtrace::label
