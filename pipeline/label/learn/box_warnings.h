#pragma once

#include "pipeline/label/learn/sightings.h"

namespace touchtrace::label {

/// Warns of boxes and masks that hardly can be right: hands far larger or smaller than a hand, and
/// drawn boxes of a hand and an object that are far apart. `samples`: with hand_m.
void warn_of_boxes(const Camera& color, const SampledFrames& samples);

}  // namespace touchtrace::label
