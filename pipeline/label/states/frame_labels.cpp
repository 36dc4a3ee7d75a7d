#include "pipeline/label/states/frame_labels.h"

#include <algorithm>
#include <cmath>

#include "pipeline/recording/frame_pairs.h"

namespace touchtrace::label {
namespace {

/// Entries [first, last) of one clip.
struct Range {
  std::size_t first, last;
};

Range entries_of(const std::vector<std::int32_t>& clips, std::size_t clip) {
  const auto found = std::ranges::equal_range(clips, static_cast<std::int32_t>(clip));
  return {static_cast<std::size_t>(found.begin() - clips.begin()),
          static_cast<std::size_t>(found.end() - clips.begin())};
}

std::optional<std::size_t> nearest_label(const std::vector<double>& times_s, const Range& range,
                                         double time_s, double max_distance_s) {
  const auto begin = times_s.begin() + static_cast<std::ptrdiff_t>(range.first),
             end = times_s.begin() + static_cast<std::ptrdiff_t>(range.last);
  auto nearest = std::lower_bound(begin, end, time_s);
  if (begin == end) return std::nullopt;
  if (nearest == end || (nearest != begin && time_s - *(nearest - 1) < *nearest - time_s))
    --nearest;
  if (std::abs(*nearest - time_s) > max_distance_s) return std::nullopt;
  return static_cast<std::size_t>(nearest - times_s.begin());
}

}  // namespace

std::vector<FrameLabel> frame_labels(const Recording& recording, const Timeline& timeline,
                                     const Labels& labels) {
  std::vector<FrameLabel> result(timeline.camera_time_s.size());
  const double label_period_s = 1.0 / rate_of(labels.time_s, recording.camera.rate_hz);
  const auto clips = clip_frames(recording);
  for (std::size_t clip = 0; clip < clips.size(); ++clip) {
    const auto [first, count] = std::pair(clips[clip].first, clips[clip].count);
    const Range of_clip = entries_of(labels.clip, clip), raw = entries_of(labels.raw.clip, clip);
    for (std::size_t i = first; i < first + count; ++i) {
      result[i].clip = clip;
      result[i].label =
          nearest_label(labels.time_s, of_clip, timeline.camera_time_s[i], label_period_s);
      if (raw.last - raw.first == count) result[i].raw = raw.first + (i - first);
    }
    if (clips[clip].is_usable() && clips[clip].has_boxes())
      result[clips[clip].box_frame].has_boxes = true;
  }
  return result;
}

}  // namespace touchtrace::label
