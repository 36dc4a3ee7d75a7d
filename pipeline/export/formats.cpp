#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/dataset/label_frames.h"
#include "pipeline/export/export.h"
#include "pipeline/export/predictions.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

using enum FileKind;

const std::array<ExportFormat, 6>& all_formats() {
  static const std::array<ExportFormat, 6> formats{{
      {"csv",
       "tables with a header row",
       {labels, recording, predictions},
       false,
       false,
       write_csv},
      {"npz", "arrays for numpy.load", {labels, recording, predictions}, false, false, write_npz},
      {"tum",
       "folder with trajectories hand.txt and object.txt, readable by evo",
       {labels, predictions},
       true,
       false,
       write_tum},
      {"mcap",
       "file of ROS 2 messages for Foxglove and the mcap libraries",
       {labels, recording, predictions},
       true,
       true,
       write_mcap},
      {"rosbag2",
       "folder with the MCAP file and metadata.yaml, for ros2 bag and rosbags",
       {labels, recording, predictions},
       true,
       true,
       write_rosbag2},
      {"onnx",
       "network for onnxruntime, normalisation included",
       {model},
       false,
       false,
       write_onnx},
  }};
  return formats;
}

bool fits(const ExportFormat& format, FileKind kind) {
  return std::ranges::find(format.inputs, kind) != format.inputs.end();
}

const ExportFormat& find_format(const std::string& name, const ExportRequest& request) {
  const auto names = formats_of(request.kind);
  const auto found = std::ranges::find(all_formats(), name, &ExportFormat::name);
  if (found == all_formats().end())
    throw usage_error(fmt::format("unknown format '{}'{}", name, did_you_mean(name, names)),
                      "formats of this file: " + comma_separated(names));
  if (!fits(*found, request.kind))
    throw usage_error(fmt::format("{} is {}, which cannot be written as {}", request.input.string(),
                                  describe(request.kind), name),
                      "formats of this file: " + comma_separated(names));
  return *found;
}

void require_effect(const ExportFormat& format, const ExportRequest& request) {
  const bool is_recording = request.kind == recording;
  if (!request.recording.empty() && (!format.uses_recording || is_recording))
    throw usage_error(
        fmt::format("--recording has no effect on {} of {}", format.name, describe(request.kind)),
        "leave it out");
  if (!request.images) return;
  if (!format.uses_images)
    throw usage_error(fmt::format("--images has no effect on {}", format.name),
                      "leave it out, or choose mcap or rosbag2");
  if (!is_recording && request.recording.empty())
    throw usage_error("--images needs a recording", "give --recording FILE");
}

/// What is wrong with predictions of this recording; empty: nothing.
std::string prediction_fault(const Predictions& predictions, const Recording& recording) {
  constexpr double max_late_s = 1.0;
  for (std::size_t i = 0; i < predictions.time_s.size(); ++i) {
    const auto clip = static_cast<std::size_t>(predictions.clip[i]);
    if (clip >= recording.clips.size())
      return fmt::format("they are of clip {}, it has {} clips", clip, recording.clips.size());
    const double start_s = recording.clips[clip].start_s, end_s = recording.clips[clip].end_s;
    const double time_s = predictions.time_s[i];
    if (!(time_s >= start_s - max_late_s && time_s <= end_s + max_late_s))
      return fmt::format(
          "a prediction of clip {} is at {:.3f} s, the clip is from {:.3f} to {:.3f} s", clip,
          time_s, start_s, end_s);
  }
  return {};
}

/// Throws data_error if labels or predictions are of another recording.
void require_own_recording(const ExportRequest& request) {
  if (request.recording.empty()) return;
  const RecordingReader reader(request.recording);
  const auto fault = request.kind == labels
                         ? label_frame_fault(read_labels(request.input), reader.recording())
                         : prediction_fault(read_predictions(request.input), reader.recording());
  if (!fault.empty())
    throw data_error(fmt::format("{} does not belong to {}: {}", request.input.string(),
                                 request.recording.string(), fault),
                     "give the recording that it was made of");
}

}  // namespace

std::span<const ExportFormat> export_formats() { return all_formats(); }

std::vector<std::string> formats_of(FileKind kind) {
  std::vector<std::string> names;
  for (const ExportFormat& format : all_formats())
    if (fits(format, kind)) names.emplace_back(format.name);
  return names;
}

std::vector<std::filesystem::path> export_file(const std::string& name,
                                               const ExportRequest& request) {
  const ExportFormat& format = find_format(name, request);
  require_effect(format, request);
  require_own_recording(request);
  return format.write(request);
}

}  // namespace touchtrace
