#pragma once

#include "pipeline/label/learn/sightings.h"
#include "pipeline/label/observe/color_classes.h"

namespace touchtrace::label {

struct LearntColors {
  ColorClasses classes;
  bool separates_object = true;  ///< false: the object has the hand's colour
  /// Radius of an object that has colours of the rest; nullopt: it has not.
  std::optional<double> shared_radius_m = std::nullopt;
};

/// Learns the colours of hand and object and classifies the samples. Colours come from the boxes
/// or, if the hand hides the object there, from what moves near the hand in other frames. Where
/// most of the object in its boxes has colours of the rest, such as a sleeve's, it is what of these
/// colours is small: see remove_large_components(). Throws data_error if an object's box contains
/// only background or no hand is found.
LearntColors learn_colors(const Segmenter& segmenter, const std::string& object,
                          SampledFrames& samples, int num_threads);

}  // namespace touchtrace::label
