#include "pipeline/recording/recording_layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>

#include "pipeline/recording/camera_schema.h"
#include "pipeline/recording/frame_pairs.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/validate.h"

namespace touchtrace {
namespace {

constexpr double max_host_time_s = 1e6;
constexpr double float_depth_count_m = 0.00025;  ///< of depth images stored as floats

using Images = std::pair<const h5::Loader*, std::string>;

std::vector<Images> color_datasets(const CameraLayout& l) {
  return {{&l.color, l.color_images}, {&l.background, "color"}, {&l.board, "color"}};
}

std::vector<Images> depth_datasets(const CameraLayout& l) {
  return {{&l.depth, l.depth_images}, {&l.background, "depth"}, {&l.board, "depth"}};
}

/// Height and width of the first dataset that exists; zeros if there is none of this rank.
std::array<int, 2> image_size(const std::vector<Images>& datasets, std::size_t rank) {
  for (const auto& [group, name] : datasets)
    if (const auto shape = group->shape(name); shape.size() == rank)
      return {static_cast<int>(std::min<hsize_t>(shape[1], INT_MAX)),
              static_cast<int>(std::min<hsize_t>(shape[2], INT_MAX))};
  return {};
}

void set_image_sizes(const CameraLayout& layout, CameraInfo& info) {
  const auto color = image_size(color_datasets(layout), 4),
             depth = image_size(depth_datasets(layout), 3);
  info.height = color[0], info.width = color[1];
  if (depth != color) info.depth_height = depth[0], info.depth_width = depth[1];
}

void read_times(const h5::Loader& group, const std::string& images, double shift_s,
                CameraTimes& times) {
  if (!group.has(images) && !group.has("host_time_s")) return;
  serialize_camera_times(group, times);
  group.faults().require(times.host_time_s.empty() || group.has(images), group.path(images),
                         "the dataset is missing");
  for (double& time_s : times.host_time_s) time_s -= shift_s;
  if (times.device_time_s.empty()) times.device_time_s = times.host_time_s;
  fill_sequence(times.sequence, times.host_time_s, 0.0);
  validate(times, group.path(), group.faults());
}

/// Sets the depth unit; returns the unit of depth images that are stored as floats.
double set_depth_unit(const CameraLayout& layout, const CameraAttributes& a, CameraInfo& info) {
  bool has_integers = false, has_floats = false;
  for (const auto& [group, name] : depth_datasets(layout))
    if (group->has(name)) (group->is_float(name) ? has_floats : has_integers) = true;
  FileFaults& faults = layout.depth.faults();
  const std::string unit = attribute_path(layout.depth.path(), "depth_unit_m");
  faults.require(!(has_floats && has_integers), layout.depth.path(layout.depth_images),
                 "expected depth images of one type, found integers and floats");
  faults.require(!has_integers || !a.depth_unit_m.empty(), unit,
                 "missing; expected the metres of a count, such as 0.001");
  if (!a.depth_unit_m.empty()) info.depth_unit_m = a.depth_unit_m[0];
  if (!has_floats) return 1.0;
  const double float_unit_m = a.depth_unit_m.empty() ? 1.0 : info.depth_unit_m;
  info.depth_unit_m = float_depth_count_m;
  return float_unit_m;
}

double rate_hz(const CameraAttributes& a, const CameraTimes& times, double fallback) {
  return a.rate_hz.empty() ? rate_of(times.host_time_s, fallback) : a.rate_hz[0];
}

void read_camera(const CameraLayout& layout, double shift_s, RecordingStreams& streams) {
  CameraInfo& info = streams.recording.camera;
  CameraAttributes color, depth;
  set_image_sizes(layout, info);
  serialize_color(layout.color, color);
  serialize_depth(layout.depth, depth);
  set_color_attributes(color, layout.color, info);
  set_depth_attributes(depth, layout.depth, info);
  if (layout.is_schema_1) read_driver_values_1(layout.color, info);
  streams.float_depth_unit_m = set_depth_unit(layout, depth, info);
  read_times(layout.color, layout.color_images, shift_s, streams.color_times);
  if (!layout.is_schema_1 || layout.depth.has(layout.depth_images))
    read_times(layout.depth, layout.depth_images, shift_s, streams.depth_times);
  const bool has_depth = streams.depth_times.frames() > 0;
  info.rate_hz = has_depth ? rate_hz(depth, streams.depth_times, info.rate_hz)
                           : rate_hz(color, streams.color_times, info.rate_hz);
}

void read_gloves(const h5::Loader& root, double shift_s, Recording& recording) {
  for (std::size_t i = 0; i < max_gloves && root.has(glove_group(i)); ++i) {
    GloveStream& glove = recording.gloves.emplace_back(read_glove(root.group(glove_group(i))));
    for (double& time_s : glove.host_time_s) time_s -= shift_s;
    if (!glove.inertial) continue;
    for (double& time_s : glove.inertial->host_time_s) time_s -= shift_s;
  }
}

/// Clip over all stamps; nullopt if there are none.
std::optional<Clip> whole_recording(const RecordingStreams& streams) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Clip whole{infinity, -infinity, "object", false, {}, {}};
  const auto include = [&](const std::vector<double>& time_s) {
    if (time_s.empty()) return;
    whole.start_s = std::min(whole.start_s, time_s.front());
    whole.end_s = std::max(whole.end_s, std::nextafter(time_s.back(), infinity));
  };
  for (const auto& glove : streams.recording.gloves) include(glove.host_time_s);
  include(streams.color_times.host_time_s);
  include(streams.depth_times.host_time_s);
  return whole.start_s < whole.end_s ? std::optional(whole) : std::nullopt;
}

void read_all_clips(const h5::Loader& root, double shift_s, RecordingStreams& streams) {
  auto whole = whole_recording(streams);
  if (whole) whole->start_s += shift_s, whole->end_s += shift_s;
  streams.recording.clips = read_clips(root, whole);
  for (auto& clip : streams.recording.clips) clip.start_s -= shift_s, clip.end_s -= shift_s;
}

}  // namespace

CameraLayout::CameraLayout(const h5::Loader& root, const std::string& schema)
    : is_schema_1(schema == recording_schema_1),
      color(is_schema_1 ? root.group("camera") : root.optional_group("color")),
      depth(is_schema_1 ? root.group("camera") : root.optional_group("depth")),
      background(root.optional_group("background")),
      board(root.optional_group("board")),
      color_images(is_schema_1 ? "color" : "image"),
      depth_images(is_schema_1 ? "depth" : "image") {}

RecordingStreams read_streams(const h5::Loader& root, const CameraLayout& layout) {
  RecordingStreams streams;
  Recording& recording = streams.recording;
  const double shift_s = clock_shift_s(root);
  root.optional_attribute("activity", recording.activity);
  root.optional_attribute("epoch_unix_s", recording.epoch_unix_s);
  recording.epoch_unix_s += shift_s;
  recording.provenance = read_provenance(root);
  read_gloves(root, shift_s, recording);
  read_camera(layout, shift_s, streams);
  read_all_clips(root, shift_s, streams);
  if (layout.board.has("color") || layout.board.has_attribute("columns"))
    serialize_board(layout.board, recording.board);
  validate(recording, layout.color.path(), layout.depth.path(), root.faults());
  return streams;
}

double clock_shift_s(const h5::Loader& root) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const char* name : {"glove0", "glove1", "color", "depth", "camera"}) {
    std::vector<double> time_s;
    const h5::Loader group = root.optional_group(name);
    group.optional_array("host_time_s", time_s, {h5::Axis{"frame"}}, {"s", ""});
    if (!time_s.empty()) first_s = std::min(first_s, time_s.front());
  }
  return first_s > max_host_time_s && std::isfinite(first_s) ? first_s : 0.0;
}

}  // namespace touchtrace
