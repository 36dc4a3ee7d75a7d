#include "pipeline/label/learn/mask_boxes.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "engine/base/integer_math.h"
#include "engine/base/statistics.h"
#include "pipeline/label/observe/mask_observer.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_compared_masks = 64;
constexpr double min_visible_part = 0.5;  // of the best frame's

/// Both bodies in the mask of one frame.
struct MaskedBodies {
  std::size_t frame;
  PixelBox hand, object;
  double hand_pixels, object_pixels;

  bool has_both() const { return !hand.empty() && !object.empty(); }
};

MaskedBodies bodies_in(const RgbdFrame& frame, std::size_t index, int width) {
  const auto pixels = [&](MaskValue value) {
    return static_cast<double>(std::ranges::count(frame.mask, value));
  };
  return {index, mask_box(frame, mask_hand, width), mask_box(frame, mask_object, width),
          pixels(mask_hand), pixels(mask_object)};
}

/// Every `stride`-th masked frame that shows both bodies.
std::vector<MaskedBodies> masked_bodies(const FrameSource& frames, const ClipFrames& clip,
                                        std::size_t stride, int width) {
  std::vector<MaskedBodies> result;
  const auto all = masked_frames(frames, clip);
  for (std::size_t i = 0; i < all.size(); i += stride)
    if (const auto bodies = bodies_in(frames.camera_frame(all[i]), all[i], width);
        bodies.has_both())
      result.push_back(bodies);
  return result;
}

double median_of(const std::vector<MaskedBodies>& all, double MaskedBodies::*pixels) {
  std::vector<double> values;
  for (const auto& one : all) values.push_back(one.*pixels);
  return median(std::move(values));
}

/// Distance between two boxes; 0 if they overlap.
double gap_px(const PixelBox& a, const PixelBox& b) {
  const int dx = std::max({0, a.x - b.x - b.width, b.x - a.x - a.width}),
            dy = std::max({0, a.y - b.y - b.height, b.y - a.y - a.height});
  return std::hypot(dx, dy);
}

MaskedBodies best_of(const std::vector<MaskedBodies>& all) {
  const double hand = median_of(all, &MaskedBodies::hand_pixels),
               object = median_of(all, &MaskedBodies::object_pixels);
  const auto visible_part = [&](const MaskedBodies& one) {
    return std::min(one.hand_pixels / hand, one.object_pixels / object);
  };
  const double least =
      min_visible_part * visible_part(*std::ranges::max_element(all, {}, visible_part));
  return *std::ranges::min_element(all, {}, [&](const MaskedBodies& one) {
    const double part = visible_part(one);
    return std::tuple(part < least, gap_px(one.hand, one.object), -part);
  });
}

}  // namespace

std::span<const std::size_t> masked_frames(const FrameSource& frames, const ClipFrames& clip) {
  const auto& all = frames.masked_frames;
  return {std::ranges::lower_bound(all, clip.first),
          std::ranges::lower_bound(all, clip.first + clip.count)};
}

std::optional<MaskValue> only_masked_body(const FrameSource& frames) {
  bool hand = false, object = false;
  const auto& masked = frames.masked_frames;
  const std::size_t stride = std::max<std::size_t>(1, ceil_div(masked.size(), max_compared_masks));
  for (std::size_t i = 0; i < masked.size(); i += stride) {
    const auto mask = frames.camera_frame(masked[i]).mask;
    hand = hand || std::ranges::count(mask, mask_hand) > 0;
    object = object || std::ranges::count(mask, mask_object) > 0;
    if (hand && object) break;
  }
  if (hand == object) return std::nullopt;
  return hand ? mask_hand : mask_object;
}

bool has_mask_of_both(const FrameSource& frames, int width, const ClipFrames& clip) {
  return std::ranges::any_of(masked_frames(frames, clip), [&](std::size_t i) {
    return bodies_in(frames.camera_frame(i), i, width).has_both();
  });
}

void set_mask_boxes(const FrameSource& frames, int width, ClipFrames& clip) {
  const std::size_t count = masked_frames(frames, clip).size();
  if (count == 0) return;
  const std::size_t stride = ceil_div(count, max_compared_masks);
  auto all = masked_bodies(frames, clip, stride, width);
  if (all.empty() && stride > 1) all = masked_bodies(frames, clip, 1, width);
  if (all.empty()) return;
  const auto best = best_of(all);
  clip.hand_box = best.hand, clip.object_box = best.object, clip.box_frame = best.frame;
  clip.has_mask_boxes = true;
}

}  // namespace touchtrace::label
