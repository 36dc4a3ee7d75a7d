#include "pipeline/label/states/timeline.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/clip_range.h"

namespace touchtrace::label {
namespace {

constexpr double max_rate_error = 0.05;
// README.md has the sources.
constexpr double min_latency_periods = 1.0, max_latency_periods = 3.0;

/// Device time of a glove frame: its counter at the nominal rate, 0 at the first frame.
double device_time_s(const GloveStream& glove, std::uint64_t sequence) {
  return (static_cast<double>(sequence) - static_cast<double>(glove.sequence.front())) /
         glove.info.rate_hz;
}

void require_glove(const Recording& recording) {
  if (recording.gloves.empty() || recording.gloves.front().frames() == 0)
    throw data_error("recording has no glove frames to label",
                     "record with the glove connected; run: touchtrace check RECORDING");
  if (recording.clips.empty())
    throw data_error("recording has no clips", "mark at least one clip, with one grasp each");
}

void require_camera(const Recording& recording) {
  if (recording.camera_times.frames() == 0)
    throw data_error("recording has no camera frames",
                     "record with the camera connected; run: touchtrace check RECORDING");
}

void require_rate(const ClockFit& clock, const char* stream) {
  if (std::abs(clock.rate - 1.0) > max_rate_error)
    throw data_error(
        fmt::format("{} counter runs at {:.3g} times its nominal rate", stream, 1.0 / clock.rate),
        "check the stream's nominal rate and counter; run: touchtrace check RECORDING");
}

}  // namespace

double Timeline::glove_time_s(std::uint64_t sequence) const {
  return glove->host_time_s(static_cast<double>(sequence) / glove_rate_hz) - 0.5 * glove_scan_s;
}

void Timeline::set_latency(double new_latency_s, double sigma_s) {
  for (double& time_s : camera_time_s) time_s -= new_latency_s - latency_s;
  latency_s = new_latency_s, latency_sigma_s = sigma_s;
}

Timeline align_glove(const Recording& recording) {
  require_glove(recording);
  Timeline timeline;
  const auto& stream = recording.gloves.front();
  std::vector<double> device_s;
  for (auto sequence : stream.sequence) device_s.push_back(device_time_s(stream, sequence));
  timeline.glove = fit_clock(device_s, stream.host_time_s);
  require_rate(*timeline.glove, "glove");
  timeline.glove_scan_s = stream.info.scan_s;
  timeline.glove_rate_hz = stream.info.rate_hz;
  timeline.glove->offset_s -=
      timeline.glove->rate * static_cast<double>(stream.sequence.front()) / stream.info.rate_hz;
  return timeline;
}

Timeline align(const Recording& recording) {
  Timeline timeline = recording.gloves.empty() ? Timeline{} : align_glove(recording);
  require_camera(recording);
  timeline.camera =
      fit_clock(recording.camera_times.device_time_s, recording.camera_times.host_time_s);
  require_rate(timeline.camera, "camera");
  for (double device_s : recording.camera_times.device_time_s)
    timeline.camera_time_s.push_back(timeline.camera.host_time_s(device_s));
  const double period_s = 1.0 / recording.camera.rate_hz;
  if (timeline.glove)
    timeline.set_latency(0.5 * (min_latency_periods + max_latency_periods) * period_s,
                         (max_latency_periods - min_latency_periods) * period_s / std::sqrt(12.0));
  return timeline;
}

namespace {

/// Every counter value of the glove inside a clip.
void append_glove_frames(const GloveStream& glove, const Timeline& timeline, const Clip& clip,
                         std::int32_t index, std::vector<LabelTime>& to) {
  const auto within = [&](std::uint64_t s) {
    const double t = timeline.glove_time_s(s);
    return t >= clip.start_s && t <= clip.end_s;
  };
  const auto& sequence = glove.sequence;
  auto next = std::ranges::find_if(sequence, within);
  if (next == sequence.end()) return;
  for (auto s = *next; next != sequence.end() && within(*next); ++s) {
    const bool arrived = *next == s;
    to.push_back({timeline.glove_time_s(s), index, arrived ? next - sequence.begin() : -1});
    if (arrived) ++next;
  }
}

}  // namespace

std::vector<LabelTime> label_times(const Recording& recording, const Timeline& timeline) {
  std::vector<LabelTime> result;
  for (std::size_t i = 0; i < recording.clips.size(); ++i) {
    const auto& clip = recording.clips[i];
    const auto index = static_cast<std::int32_t>(i);
    if (clip.object_fell) continue;
    if (timeline.glove)
      append_glove_frames(recording.gloves.front(), timeline, clip, index, result);
    else
      for (const double time_s : timeline.camera_time_s)
        if (time_s >= clip.start_s && time_s <= clip.end_s) result.push_back({time_s, index, -1});
  }
  return result;
}

std::vector<ClipFrames> clip_frames(const Recording& recording) {
  std::vector<ClipFrames> result;
  for (const auto& clip : recording.clips) {
    const auto range = arrived_in(clip, recording.camera_times.host_time_s);
    ClipFrames frames{range.first, clip.object_fell ? 0 : range.size(), clip.hand_box,
                      clip.object_box, clip.object};
    frames.box_frame = clip.box_frame.value_or(range.first);
    frames.problem = fmt::format("{}", fmt::join(box_faults(clip, recording), "; "));
    result.push_back(std::move(frames));
  }
  return result;
}

}  // namespace touchtrace::label
