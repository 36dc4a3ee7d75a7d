#include "engine/train/segment_rows.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {

void check_segments(const ModelSpec& spec, std::span<const std::int32_t> first_frame,
                    std::size_t frames) {
  for (const auto first : first_frame)
    if (first < 0 || std::size_t(first) + spec.segment_frames > frames)
      throw data_error(fmt::format("an object's segment of {} frames from frame {} does not lie in "
                                   "the tactile stream of {}",
                                   spec.segment_frames, first, frames),
                       "use a longer recording");
}

std::vector<std::int32_t> segment_last_frames(const ModelSpec& spec,
                                              std::span<const std::int32_t> first_frame) {
  std::vector<std::int32_t> last_frame;
  for (const auto first : first_frame) last_frame.push_back(first + spec.segment_frames - 1);
  return last_frame;
}

std::vector<float> contrast_weights(std::span<const std::int32_t> object, double weight) {
  const auto positives = [&](auto of) { return std::ranges::count(object, of) - 1; };
  const auto is_anchor = [&](auto of) {
    return positives(of) > 0 && positives(of) + 1 < std::ssize(object);
  };
  const auto anchors = static_cast<double>(std::ranges::count_if(object, is_anchor));
  std::vector<float> weights;
  for (const auto of : object)
    weights.push_back(is_anchor(of) ? static_cast<float>(weight / (anchors * double(positives(of))))
                                    : 0.0f);
  return weights;
}

}  // namespace touchtrace
