#include "pipeline/label/learn/box_warnings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/progress.h"
#include "pipeline/label/estimate/body_fit.h"

namespace touchtrace::label {
namespace {

/// Larger side of a hand's box: one with spread fingers and the wrist has 0.3 m, hands in nine
/// public recordings 0.065 to 0.16 m.
constexpr double min_hand_m = 0.035, max_hand_m = 0.4;
constexpr double max_held_m = 0.3;  // between the nearest points in the boxes
constexpr std::size_t max_box_points = 300;

/// Warns of boxes and masks of hands that are far larger or smaller than a hand.
void warn_of_hand_size(const Camera& color, const SampledFrame& sample) {
  const PixelBox& box = sample.clip->hand_box;
  const double width_m = box.width * sample.hand_m->z() / color.fx,
               height_m = box.height * sample.hand_m->z() / color.fy,
               larger_m = std::max(width_m, height_m);
  if (larger_m >= min_hand_m && larger_m <= max_hand_m) return;
  Progress::warn(fmt::format(
      "the hand's {} in camera frame {} is {:.3f} x {:.3f} m, {} than a hand: the depth's unit "
      "may be wrong (import --depth-scale), or the labels may be of another part",
      sample.clip->has_mask_boxes ? "mask" : "box", sample.index, width_m, height_m,
      larger_m > max_hand_m ? "larger" : "smaller"));
}

/// Smallest distance [m] between the points in a frame's boxes; infinite if one has none.
double distance_of_boxes_m(const SampledFrame& sample) {
  const auto points_of = [&](const PixelBox& box) {
    std::vector<Eigen::Vector3f> points_m;
    for (const auto& point : points_in(sample.surface, box)) points_m.push_back(point.position_m);
    return every_nth(points_m, max_box_points);
  };
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& hand_m : points_of(sample.clip->hand_box))
    for (const auto& object_m : points_of(sample.clip->object_box))
      nearest_m = std::min<double>(nearest_m, (hand_m - object_m).norm());
  return nearest_m;
}

/// Warns of an object that the hand does not hold.
void warn_of_distance(const SampledFrame& sample) {
  const double distance_m = distance_of_boxes_m(sample);
  if (std::isfinite(distance_m) && distance_m > max_held_m)
    Progress::warn(
        fmt::format("the hand's and the object's box in camera frame {} are {:.2f} m apart, but "
                    "the hand should hold the object there: look at the boxes (`touchtrace mark`)",
                    sample.index, distance_m));
}

}  // namespace

void warn_of_boxes(const Camera& color, const SampledFrames& samples) {
  for (const auto& sample : samples) {
    if (sample.has_boxes() && sample.hand_m) warn_of_hand_size(color, sample);
    if (sample.has_drawn_boxes()) warn_of_distance(sample);
  }
}

}  // namespace touchtrace::label
