#include "engine/train/segment_rows.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {

void check_segments(const ModelSpec& spec, std::span<const std::int32_t> first_frame,
                    std::size_t frames) {
  for (const auto first : first_frame)
    if (first < 0 || std::size_t(first) + spec.segment_frames > frames)
      throw data_error(fmt::format("object segment of {} frames from frame {} is outside the "
                                   "tactile stream of {} frames",
                                   spec.segment_frames, first, frames),
                       "use a longer recording");
}

std::vector<std::int32_t> segment_ends(const ModelSpec& spec,
                                       std::span<const std::int32_t> first_frame) {
  std::vector<std::int32_t> window_end;
  for (const auto first : first_frame) window_end.push_back(first + spec.segment_frames - 1);
  return window_end;
}

std::vector<float> contrast_weights(std::span<const std::int32_t> object, double weight) {
  const auto positives = [&](auto id) { return std::ranges::count(object, id) - 1; };
  const auto is_anchor = [&](auto id) {
    return positives(id) > 0 && positives(id) + 1 < std::ssize(object);
  };
  const auto anchors = static_cast<double>(std::ranges::count_if(object, is_anchor));
  std::vector<float> weights;
  for (const auto id : object)
    weights.push_back(is_anchor(id) ? static_cast<float>(weight / (anchors * double(positives(id))))
                                    : 0.0f);
  return weights;
}

}  // namespace touchtrace
