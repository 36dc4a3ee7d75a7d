#include "pipeline/label/learn/learn_colors.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/statistics.h"
#include "pipeline/label/observe/split.h"

namespace touchtrace::label {
namespace {

// Least fraction of the points in the hand's boxes that are outside the object's. About 2 % of the
// boxes' area are enough for a simulated hammer.
constexpr double min_hand_alone = 0.01;
constexpr double min_visible_frames = 0.1;  // an object is rarely hidden in more of the frames
// Visible fraction of the object's disc below which colours learnt near the hand are not trusted.
constexpr double min_learnt_color_fraction = 0.4;
// Points of these colours, over the pixels of the object's disc, above which they are not the
// object's alone: sleeve and torso also have them.
constexpr double max_learnt_color_fraction = 2.0;
// Least fraction of the points in the object's boxes, outside the hand's, that are the object's.
constexpr double min_boxed_fraction = 0.5;
// Mean likeness of a patch: colours twice as rare as usual are another body's, not the hand's.
constexpr double min_hand_likeness = -0.7;

/// Whether the object's boxes leave too little of the hand's to learn its colours from.
bool are_hands_inside(const SampledFrames& samples) {
  double in_hand = 0.0, alone = 0.0;
  for (const auto& sample : samples)
    if (sample.has_boxes())
      for (const auto& point : points_in(sample.surface, sample.clip->hand_box))
        in_hand += 1.0, alone += !contains(sample.clip->object_box, point);
  return alone < min_hand_alone * in_hand;
}

void learn_boxes(const SampledFrame& sample, const std::string& object, bool is_hand_inside,
                 ColorClasses& colors) {
  const auto& [hand_box, object_box] = std::tie(sample.clip->hand_box, sample.clip->object_box);
  if (std::ranges::none_of(sample.surface, [&](const auto& p) { return contains(object_box, p); }))
    throw data_error(
        fmt::format("object {} of '{}' in camera frame {} contains only background",
                    sample.clip->has_mask_boxes ? "mask" : "box", object, sample.index),
        "draw the box on the object; run: touchtrace mark RECORDING");
  colors.learn(sample.surface, hand_box, object_box, is_hand_inside);
}

void classify(LearntColors& learnt, SampledFrames& samples, int num_threads) {
  learnt.classes.build_table();
  parallel_for(samples.size(), num_threads, [&](std::size_t i) {
    Surface& surface = samples[i].surface;
    learnt.classes.assign(surface);
    if (learnt.shared_radius_m) remove_large_components(surface, *learnt.shared_radius_m);
  });
  find_hands(samples, num_threads);
}

/// Part of the points in the object's boxes and not in the hand's that are the object's; 1 where
/// the hand's boxes contain most.
double boxed_object_fraction(const SampledFrames& samples) {
  double all = 0.0, outside_hand = 0.0, of_object = 0.0;
  for (const auto& sample : samples) {
    if (!sample.has_boxes()) continue;
    for (const auto& point : points_in(sample.surface, sample.clip->object_box)) {
      all += 1.0;
      if (contains(sample.clip->hand_box, point)) continue;
      outside_hand += 1.0;
      of_object += point.body == Body::object;
    }
  }
  return outside_hand < 0.5 * all ? 1.0 : of_object / outside_hand;
}

/// Where most of the object has colours of the rest, lets it share them.
void share_rest_if_needed(LearntColors& learnt, double radius_m, SampledFrames& samples,
                          int num_threads) {
  if (boxed_object_fraction(samples) >= min_boxed_fraction) return;
  learnt.classes.let_object_share_rest(true);
  learnt.shared_radius_m = radius_m;
  classify(learnt, samples, num_threads);
  if (boxed_object_fraction(samples) >= min_boxed_fraction) return;
  learnt.classes.let_object_share_rest(false);
  learnt.shared_radius_m.reset();
  classify(learnt, samples, num_threads);
}

Surface all_near_hand(const SampledFrames& samples, const BoxedObject& boxed) {
  Surface all;
  for (const auto& sample : samples)
    std::ranges::copy(near_hand(sample, boxed), std::back_inserter(all));
  return all;
}

/// Points on the hand in a frame that shows the object elsewhere, if it does.
Surface points_on_hand(const SampledFrame& sample, const BoxedObject& boxed) {
  const double apart_m = hand_patch_radius_m + object_patch_radius_factor * boxed.radius_m;
  const auto object = sighting_of(sample, boxed);
  if (!object || (object->patch.centroid_m - *sample.hand_m).norm() < apart_m) return {};
  const auto hand = find_patch(sample.surface, Body::hand, *sample.hand_m, hand_patch_radius_m, 1);
  if (!hand || hand->likeness < min_hand_likeness) return {};
  Surface on_hand;
  std::ranges::copy_if(sample.surface, std::back_inserter(on_hand), [&](const SurfacePoint& point) {
    return point.body != Body::rest &&
           (point.position_m.cast<double>() - hand->centroid_m).norm() < hand_patch_radius_m;
  });
  return on_hand;
}

/// Points of all frames. Those of the object's class are fingers: the object's box contained some.
Surface all_on_hand(const SampledFrames& samples, const BoxedObject& boxed, int num_threads) {
  std::vector<Surface> of_frames(samples.size());
  parallel_for(samples.size(), num_threads,
               [&](std::size_t i) { of_frames[i] = points_on_hand(samples[i], boxed); });
  Surface all;
  for (const auto& surface : of_frames) std::ranges::copy(surface, std::back_inserter(all));
  return all;
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
                          SampledFrames& samples, int num_threads) {
  LearntColors learnt;
  auto& colors = learnt.classes;
  const bool is_hand_inside = are_hands_inside(samples);
  for (const auto& sample : samples)
    if (sample.has_boxes()) learn_boxes(sample, object, is_hand_inside, colors);
  classify(learnt, samples, num_threads);
  const auto boxed = boxed_object(segmenter.color_camera(), object, samples);
  share_rest_if_needed(learnt, boxed.radius_m, samples, num_threads);
  colors.learn_hand_from(all_on_hand(samples, boxed, num_threads));
  classify(learnt, samples, num_threads);
  const auto is_visible = [&](double min_fraction) {
    const auto sightings = sightings_of(samples, boxed, num_threads);
    return static_cast<double>(sightings.size()) >=
               min_visible_frames * static_cast<double>(samples.size()) &&
           visible_disc_fraction(segmenter, sightings, boxed.radius_m) >= min_fraction;
  };
  if (is_visible(0.0)) return learnt;
  colors.learn_object_from(all_near_hand(samples, boxed));
  classify(learnt, samples, num_threads);
  if (is_visible(min_learnt_color_fraction) &&
      class_disc_fraction(segmenter, samples, boxed.radius_m) <= max_learnt_color_fraction)
    return learnt;
  colors.learn_object_from({});
  classify(learnt, samples, num_threads);
  learnt.separates_object = false;
  return learnt;
}

}  // namespace touchtrace::label
