#pragma once

#include "pipeline/label/learn/sightings.h"
#include "pipeline/label/observe/color_classes.h"

namespace touchtrace::label {

struct LearntColors {
  ColorClasses classes;
  bool separates_object = true;  ///< false: the object has the hand's colour
};

/// Learns the colours of hand and object and classifies the samples. Colours come from the boxes
/// or, if the hand hides the object there, from what moves near the hand in other frames. Throws
/// data_error if an object's box contains only background or no hand is found.
LearntColors learn_colors(const Segmenter& segmenter, const std::string& object,
                          SampledFrames& samples);

}  // namespace touchtrace::label
