#include "pipeline/label/learn/learn_colors.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr double min_visible_frames = 0.1;  // an object is rarely hidden in more of the frames
// Visible fraction of the object's disc below which colours learnt near the hand are not trusted.
constexpr double min_learnt_color_fraction = 0.4;
// Points of these colours, over the pixels of the object's disc, above which they are not the
// object's alone: sleeve and torso also have them.
constexpr double max_learnt_color_fraction = 2.0;
// Mean likeness of a patch: colours twice as rare as usual are another body's, not the hand's.
constexpr double min_hand_likeness = -0.7;

void learn_boxes(const SampledFrame& sample, const std::string& object, ColorClasses& colors) {
  const auto& [hand_box, object_box] = std::tie(sample.clip->hand_box, sample.clip->object_box);
  if (std::ranges::none_of(sample.surface, [&](const auto& p) { return contains(object_box, p); }))
    throw data_error(
        fmt::format("object {} of '{}' in camera frame {} contains only background",
                    sample.clip->has_mask_boxes ? "mask" : "box", object, sample.index),
        "draw the box on the object; run: touchtrace mark RECORDING");
  colors.learn(sample.surface, hand_box, object_box);
}

void classify(ColorClasses& colors, SampledFrames& samples) {
  colors.build_table();
  for (auto& sample : samples) colors.assign(sample.surface);
  find_hands(samples);
}

Surface all_near_hand(const SampledFrames& samples, const BoxedObject& boxed) {
  Surface all;
  for (const auto& sample : samples)
    std::ranges::copy(near_hand(sample, boxed), std::back_inserter(all));
  return all;
}

/// Points on the hand in frames that show the object elsewhere. Those of the object's class are
/// fingers: the object's box contained some.
Surface points_on_hand(const SampledFrames& samples, const BoxedObject& boxed) {
  const double apart_m = hand_patch_radius_m + object_patch_radius_factor * boxed.radius_m;
  Surface on_hand;
  for (const auto& sample : samples) {
    const auto object = sighting_of(sample, boxed);
    if (!object || (object->patch.centroid_m - *sample.hand_m).norm() < apart_m) continue;
    const auto hand =
        find_patch(sample.surface, Body::hand, *sample.hand_m, hand_patch_radius_m, 1);
    if (!hand || hand->likeness < min_hand_likeness) continue;
    std::ranges::copy_if(
        sample.surface, std::back_inserter(on_hand), [&](const SurfacePoint& point) {
          return point.body != Body::rest &&
                 (point.position_m.cast<double>() - hand->centroid_m).norm() < hand_patch_radius_m;
        });
  }
  return on_hand;
}

/// Unhidden quantile over the frames with a hand of the number of points of the object's class,
/// over the pixels of the object's disc at the hand's distance.
double class_disc_fraction(const Segmenter& segmenter, const SampledFrames& samples,
                           double radius_m) {
  std::vector<double> fractions{0.0};
  for (const auto& sample : samples)
    if (sample.hand_m)
      fractions.push_back(static_cast<double>(std::ranges::count(sample.surface, Body::object,
                                                                 &SurfacePoint::body)) /
                          segmenter.disc_pixels(radius_m, sample.hand_m->z()));
  return quantile(std::move(fractions), unhidden_quantile);
}

}  // namespace

LearntColors learn_colors(const Segmenter& segmenter, const std::string& object,
                          SampledFrames& samples) {
  LearntColors learnt;
  auto& colors = learnt.classes;
  for (const auto& sample : samples)
    if (sample.has_boxes()) learn_boxes(sample, object, colors);
  classify(colors, samples);
  const auto boxed = boxed_object(segmenter.color_camera(), object, samples);
  colors.learn_hand_from(points_on_hand(samples, boxed));
  classify(colors, samples);
  const auto is_visible = [&](double min_fraction) {
    const auto sightings = sightings_of(samples, boxed);
    return static_cast<double>(sightings.size()) >=
               min_visible_frames * static_cast<double>(samples.size()) &&
           visible_disc_fraction(segmenter, sightings, boxed.radius_m) >= min_fraction;
  };
  if (is_visible(0.0)) return learnt;
  colors.learn_object_from(all_near_hand(samples, boxed));
  classify(colors, samples);
  if (is_visible(min_learnt_color_fraction) &&
      class_disc_fraction(segmenter, samples, boxed.radius_m) <= max_learnt_color_fraction)
    return learnt;
  colors.learn_object_from({});
  classify(colors, samples);
  learnt.separates_object = false;
  return learnt;
}

}  // namespace touchtrace::label
