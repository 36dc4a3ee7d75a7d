#include "pipeline/mark/boxes.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/recording/check.h"

namespace touchtrace {

PixelBox parse_box(const std::string& text) {
  const auto parts = split_text(text, ',');
  std::array<int, 4> values{};
  bool is_good = parts.size() == 4;
  for (std::size_t i = 0; is_good && i < 4; ++i) is_good = parse_whole(parts[i], values[i]);
  if (!is_good)
    throw usage_error(fmt::format("'{}' is not a box", text),
                      "write x,y,width,height in pixels, e.g. hand=120,80,60,50");
  return {values[0], values[1], values[2], values[3]};
}

void require_plausible(const ClipBoxes& boxes, const Recording& recording) {
  if (boxes.clip >= recording.clips.size())
    throw data_error(fmt::format("clip {} does not exist: there are {}, counted from 0", boxes.clip,
                                 recording.clips.size()),
                     "`touchtrace check` lists what a recording holds");
  Clip clip = recording.clips[boxes.clip];
  clip.hand_box = boxes.hand, clip.object_box = boxes.object, clip.box_frame = boxes.frame;
  auto faults = box_faults(clip, recording);
  if (boxes.hand.empty() || boxes.object.empty()) faults.emplace_back("a box is empty");
  if (!faults.empty())
    throw data_error(fmt::format("clip {}: {}", boxes.clip, fmt::join(faults, "; ")),
                     "a box is x,y,width,height in pixels of the colour image");
}

}  // namespace touchtrace
