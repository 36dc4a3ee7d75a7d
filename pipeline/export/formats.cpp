#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/export/export.h"

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
  return format.write(request);
}

}  // namespace touchtrace
