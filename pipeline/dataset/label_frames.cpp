#include "pipeline/dataset/label_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/recording/clip_range.h"

namespace touchtrace {
namespace {

/// Largest difference between a label's time and the arrival of its frame. Clocks are aligned to
/// milliseconds, so a larger one means labels of another recording.
constexpr double max_alignment_s = 1.0;
constexpr double max_clip_difference_s = 1e-3;
constexpr double min_labelled = 0.9;
constexpr double min_unix_s = 1e9;

std::string clip_fault(const Labels& labels, const Recording& recording) {
  const auto &clips = recording.clips, &labelled = labels.clips;
  if (labelled.size() != clips.size())
    return fmt::format("{} clips instead of {}", labelled.size(), clips.size());
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (labelled[i].object != clips[i].object)
      return fmt::format("clip {} is of object '{}' instead of '{}'", i, labelled[i].object,
                         clips[i].object);
    if (!(std::abs(labelled[i].start_s - clips[i].start_s) <= max_clip_difference_s &&
          std::abs(labelled[i].end_s - clips[i].end_s) <= max_clip_difference_s))
      return fmt::format("clip {} is from {:.3f} to {:.3f} s instead of {:.3f} to {:.3f} s", i,
                         labelled[i].start_s, labelled[i].end_s, clips[i].start_s, clips[i].end_s);
  }
  return {};
}

std::string time_fault(const Labels& labels, const Recording& recording, std::size_t i) {
  const auto& glove = recording.gloves.front();
  const auto frame = static_cast<std::size_t>(labels.glove_frame[i]);
  if (frame >= glove.frames())
    return fmt::format("label {} is of glove frame {} of {}", i, frame, glove.frames());
  const double time_s = labels.time_s[i], arrival_s = glove.host_time_s[frame];
  if (!(std::abs(time_s - arrival_s) <= max_alignment_s))
    return fmt::format("label {} at {:.3f} s is of glove frame {}, which arrived at {:.3f} s{}", i,
                       time_s, frame, arrival_s,
                       time_s > min_unix_s
                           ? ": times of labels are on the recording's clock, not Unix times"
                           : "");
  const auto& clip = recording.clips[static_cast<std::size_t>(labels.clip[i])];
  const double period_s = 1.0 / glove.info.rate_hz;
  if (!(time_s >= clip.start_s - period_s && time_s <= clip.end_s + period_s))
    return fmt::format("label {} at {:.3f} s is outside its clip {}, {:.3f} to {:.3f} s", i, time_s,
                       labels.clip[i], clip.start_s, clip.end_s);
  return {};
}

}  // namespace

std::string label_frame_fault(const Labels& labels, const Recording& recording) {
  if (const auto fault = clip_fault(labels, recording); !fault.empty()) return fault;
  if (recording.gloves.empty()) return {};
  const auto& sequence = recording.gloves.front().sequence;
  constexpr auto none = std::numeric_limits<std::size_t>::max();
  std::size_t previous = none;  // label with a glove frame in the same clip
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    if (previous != none && labels.clip[i] != labels.clip[previous]) previous = none;
    if (labels.glove_frame[i] < 0) continue;
    if (const auto fault = time_fault(labels, recording, i); !fault.empty()) return fault;
    const auto number = sequence[static_cast<std::size_t>(labels.glove_frame[i])];
    if (previous != none) {
      const auto before = sequence[static_cast<std::size_t>(labels.glove_frame[previous])];
      if (number != before + (i - previous))
        return fmt::format(
            "labels {} and {} are of the glove's frames number {} and {}, but a clip needs one "
            "label for each frame, lost ones included",
            previous, i, before, number);
    }
    previous = i;
  }
  return {};
}

std::string missing_labels_warning(const Labels& labels, const Recording& recording) {
  std::size_t frames = 0;
  for (const Clip& clip : recording.clips)
    if (!clip.object_fell) frames += arrived_in(clip, recording.gloves.front().host_time_s).size();
  const auto labelled = static_cast<std::size_t>(
      std::ranges::count_if(labels.glove_frame, [](auto frame) { return frame >= 0; }));
  if (static_cast<double>(labelled) >= min_labelled * static_cast<double>(frames)) return {};
  return fmt::format("{} of the glove's {} frames in clips have no label", frames - labelled,
                     frames);
}

}  // namespace touchtrace
