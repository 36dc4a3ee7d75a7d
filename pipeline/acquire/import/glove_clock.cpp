#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/acquire/import/glove_import.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

/// The only offset of a time zone, a multiple of `step_s`, with which the glove's times overlap the
/// images'; 0: none or several.
double time_zone_offset_s(const GloveStream& glove, const RecordedTime& images, double step_s) {
  constexpr double max_offset_s = 14 * 3600.0;
  double only_s = 0.0;
  for (double offset_s = -max_offset_s; offset_s <= max_offset_s; offset_s += step_s) {
    const bool overlaps = glove.host_time_s.front() + offset_s <= images.epoch_s + images.last_s &&
                          glove.host_time_s.back() + offset_s >= images.epoch_s + images.first_s;
    if (overlaps && only_s != 0.0) return 0.0;
    if (overlaps) only_s = offset_s;
  }
  return only_s;
}

/// Time zones differ by whole hours, some by quarters.
double time_zone_offset_s(const GloveStream& glove, const RecordedTime& images) {
  const double hours_s = time_zone_offset_s(glove, images, 3600.0);
  return hours_s != 0.0 ? hours_s : time_zone_offset_s(glove, images, 900.0);
}

}  // namespace

std::vector<Clip> clips_between_pauses(const GloveStream& glove, const std::string& object) {
  const auto& time_s = glove.host_time_s;
  std::vector<Clip> clips;
  for (std::size_t first = 0, next = 1; first < time_s.size(); first = next++) {
    while (next < time_s.size() && !is_pause(time_s[next] - time_s[next - 1], glove.info.rate_hz))
      ++next;
    if (next < first + 2 || time_s[next - 1] <= time_s[first]) continue;
    double end_s = time_s[next - 1] + 1.0 / glove.info.rate_hz;
    if (next < time_s.size()) end_s = std::min(end_s, time_s[next]);
    clips.push_back({time_s[first], end_s, object, false, {}, {}});
  }
  return clips;
}

void move_to_clock(GloveStream& glove, const RecordedTime& images, double offset_s) {
  const double first_s = glove.host_time_s.front(), last_s = glove.host_time_s.back();
  const double images_first_s = images.epoch_s + images.first_s,
               images_last_s = images.epoch_s + images.last_s;
  if (!(first_s <= images_last_s && last_s >= images_first_s)) {
    const double time_zone_s = time_zone_offset_s(glove, images);
    throw data_error(
        fmt::format("the glove's times, {:.3f} to {:.3f} s, do not overlap the images', {:.3f} to "
                    "{:.3f} s",
                    first_s, last_s, images_first_s, images_last_s),
        time_zone_s != 0.0
            ? fmt::format("if the glove's file has local time, as WiReSens writes it, give "
                          "--glove-offset {:.0f}",
                          offset_s + time_zone_s)
            : "times of both must come from one computer; --glove-offset SECONDS corrects a known "
              "difference");
  }
  for (double& time_s : glove.host_time_s) time_s -= images.epoch_s;
}

}  // namespace touchtrace
