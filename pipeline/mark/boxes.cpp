#include "pipeline/mark/boxes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

std::string text_of(const PixelBox& box) {
  return fmt::format("{},{},{},{}", box.x, box.y, box.width, box.height);
}

void require_inside(const PixelBox& box, const char* name, const CameraInfo& camera) {
  if (box.empty())
    throw data_error(fmt::format("the box {} of the {} is empty", text_of(box), name),
                     "width and height are positive: x,y,width,height");
  const bool is_inside = box.x >= 0 && box.y >= 0 && box.x < camera.width &&
                         box.y < camera.height && box.width <= camera.width - box.x &&
                         box.height <= camera.height - box.y;
  if (is_inside) return;
  const bool are_corners = box.x < box.width && box.y < box.height && box.x >= 0 && box.y >= 0 &&
                           box.width <= camera.width && box.height <= camera.height;
  throw data_error(
      fmt::format("the box {} of the {} leaves the image of {}x{} pixels", text_of(box), name,
                  camera.width, camera.height),
      are_corners ? fmt::format("a box is x,y,width,height: for the corners ({}, {}) and ({}, {}) "
                                "write {}",
                                box.x, box.y, box.width, box.height,
                                text_of({box.x, box.y, box.width - box.x, box.height - box.y}))
                  : "a box is x,y,width,height in pixels of the colour image");
}

}  // namespace

PixelBox parse_box(const std::string& text) {
  const auto parts = split_text(text, ',');
  std::array<int, 4> values{};
  bool is_good = parts.size() == 4;
  for (std::size_t i = 0; is_good && i < 4; ++i) {
    const char* const end = parts[i].data() + parts[i].size();
    const auto [rest, fault] = std::from_chars(parts[i].data(), end, values[i]);
    is_good = fault == std::errc{} && rest == end;
  }
  if (!is_good)
    throw usage_error(fmt::format("'{}' is not a box", text),
                      "write x,y,width,height in pixels, e.g. hand=120,80,60,50");
  return {values[0], values[1], values[2], values[3]};
}

std::size_t first_frame(const Recording& recording, const Clip& clip) {
  const auto& times_s = recording.camera_times.host_time_s;
  const auto first = std::ranges::lower_bound(times_s, clip.start_s);
  if (first == times_s.end() || *first >= clip.end_s)
    throw data_error(
        fmt::format("the clip from {} to {} s has no camera frame", clip.start_s, clip.end_s),
        "mark another clip");
  return static_cast<std::size_t>(first - times_s.begin());
}

void require_plausible(const ClipBoxes& boxes, const Recording& recording) {
  if (boxes.clip >= recording.clips.size())
    throw data_error(fmt::format("clip {} does not exist: there are {}, counted from 0", boxes.clip,
                                 recording.clips.size()),
                     "`touchtrace check` lists what a recording holds");
  const auto& times_s = recording.camera_times.host_time_s;
  const Clip& clip = recording.clips[boxes.clip];
  if (boxes.frame >= times_s.size() || times_s[boxes.frame] < clip.start_s ||
      times_s[boxes.frame] > clip.end_s)
    throw data_error(fmt::format("frame {} is not in clip {}", boxes.frame, boxes.clip),
                     fmt::format("its first frame is {}", first_frame(recording, clip)));
  require_inside(boxes.hand, "hand", recording.camera);
  require_inside(boxes.object, "object", recording.camera);
  if (text_of(boxes.hand) == text_of(boxes.object))
    throw data_error("hand and object have the same box", "draw each box around one of them");
}

}  // namespace touchtrace
