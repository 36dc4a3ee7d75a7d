#pragma once

#include "pipeline/label/learn/sightings.h"

namespace touchtrace::label {

/// Learns an object's shape into `model` from samples with classes.
void learn_object(SceneModel& model, const FrameSource& frames, const std::string& object,
                  SampledFrames& samples, int num_threads);

}  // namespace touchtrace::label
