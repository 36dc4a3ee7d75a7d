#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/label/estimate/learn_shape.h"
#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/observe/lift.h"

namespace touchtrace::label {

/// Points of one frame of a clip, with their classes once they are known.
struct SampledFrame {
  const ClipFrames* clip;
  std::size_t index;
  Surface surface;
  std::optional<Eigen::Vector3d> hand_m = std::nullopt;  ///< set by find_hands

  bool has_boxes() const { return index == clip->box_frame; }
  /// Whether boxes contain the whole bodies; those around masks do not contain what is hidden.
  bool has_drawn_boxes() const { return has_boxes() && !clip->has_mask_boxes; }
};

using SampledFrames = std::vector<SampledFrame>;

/// The object's patch in one of the sampled frames.
struct Sighting {
  std::size_t frame;
  Patch patch;
  std::optional<PixelBox> box;  ///< around the whole object, where a user drew one
};

/// Size and place of an object according to the clips' boxes.
struct BoxedObject {
  double radius_m;
  double unevenness_m;  ///< RMS of half the difference of half width and half height
  double from_hand_m;

  ObjectShape sphere() const;
};

/// Sets the hands' positions: the largest patch of the hand's class in the hand's box, and in other
/// frames the one with the highest patch_score() about it.
void find_hands(SampledFrames& samples, int num_threads);

/// Medians over the clips whose box frame shows the hand, with boxes as discs at the hand's
/// distance. Throws data_error if no hand box contains a hand.
BoxedObject boxed_object(const Camera& color, const std::string& object,
                         const SampledFrames& samples);

/// Points within reach of a toss from where the hand holds the object; empty without a hand.
Surface near_hand(const SampledFrame& sample, const BoxedObject& boxed);

/// Largest patch of the object's class near the hand; nullopt without one.
std::optional<Sighting> sighting_of(const SampledFrame& sample, const BoxedObject& boxed);

/// Sightings in the samples that have one.
std::vector<Sighting> sightings_of(const SampledFrames& samples, const BoxedObject& boxed,
                                   int num_threads);

/// Quantile that stands for an object that nothing hides.
inline constexpr double unhidden_quantile = 0.8;

/// Unhidden quantile over the sightings of the visible fraction of the object's disc.
double visible_disc_fraction(const Segmenter& segmenter, const std::vector<Sighting>& sightings,
                             double radius_m);

}  // namespace touchtrace::label
