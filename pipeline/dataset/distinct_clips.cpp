#include "pipeline/dataset/distinct_clips.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/dataset/fingerprint.h"

namespace touchtrace {

void DistinctClips::add(std::span<const Sequence> clips, const std::string& recording) {
  for (const Sequence& clip : clips)
    if (is_known_clip(clip.fingerprints, known_))
      throw data_error(
          fmt::format("clip {} of {} is also in another of the recordings, whole or in part",
                      clip.clip, recording),
          "give each recording once");
  for (const Sequence& clip : clips)
    std::ranges::copy(clip.fingerprints, std::back_inserter(known_));
  std::ranges::sort(known_);
}

}  // namespace touchtrace
