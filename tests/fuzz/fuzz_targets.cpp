#include "tests/fuzz/fuzz_targets.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "calib/rgbd/calibration.h"
#include "calib/rgbd/foreign_calibration.h"
#include "engine/base/error.h"
#include "engine/base/options.h"
#include "engine/base/scratch_folder.h"
#include "engine/model/model_spec.h"
#include "engine/train/safetensors.h"
#include "pipeline/acquire/glove/own_protocol.h"
#include "pipeline/acquire/import/bags/bag_file.h"
#include "pipeline/acquire/import/bags/mcap_file.h"
#include "pipeline/acquire/import/bags/ros_messages.h"
#include "pipeline/acquire/import/clip_file.h"
#include "pipeline/acquire/import/formats/matlab_file.h"
#include "pipeline/acquire/import/formats/numpy_file.h"
#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/acquire/import/gloves/glove_times.h"
#include "pipeline/acquire/import/gloves/glove_values.h"
#include "pipeline/acquire/import/intrinsics.h"
#include "pipeline/acquire/iso_time.h"
#include "pipeline/acquire/record/glove_config.h"
#include "pipeline/acquire/record/log.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/track_file.h"
#include "pipeline/acquire/tum_folder.h"
#include "pipeline/cli/configuration.h"
#include "pipeline/sweep/study_file.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

void require(bool condition, const char* invariant) {
  if (!condition) throw std::logic_error(invariant);
}

/// Calls a parser that may throw any std::exception for invalid input, except that memory is
/// exhausted.
template <class Parse>
void tolerate(Parse&& parse) {
  try {
    parse();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
  }
}

/// Feeds pieces whose size the first byte tells.
void parse_glove(const GloveProtocol& protocol, ByteSpan bytes) {
  GloveInfo info = protocol.usual_glove;
  if (protocol.fixed_taxels == 0) info.rows = 2, info.cols = 3;
  std::uint64_t next = 0;
  const auto parser = protocol.parse(info, [&](const GloveFrame& frame) {
    require(frame.sequence >= next, "frames are out of order");
    require(frame.counts.size() == static_cast<std::size_t>(info.taxels()), "a frame has no size");
    for (const auto count : frame.counts) require(count >> info.bits == 0, "a count is too large");
    next = frame.sequence + 1;
  });
  const std::size_t piece = bytes.empty() ? 1 : 1 + bytes[0] % 64;
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    parser->feed(bytes.subspan(at, std::min(piece, bytes.size() - at)), static_cast<double>(at));
}

void parse_log(const fs::path& file, ByteSpan) {
  LogReader reader(file);
  while (const auto record = reader.next())
    if (record->kind == RecordKind::description) parse_session(record->payload);
}

void parse_model(const fs::path& file, ByteSpan) {
  const TensorFile model = read_safetensors(file);
  const auto spec = model.metadata.find("spec");
  if (spec == model.metadata.end()) return;
  tolerate([&] { nlohmann::json::parse(spec->second).get<ModelSpec>(); });
}

void parse_toml(const fs::path& file, ByteSpan) {
  tolerate([&] { sweep::read_stage_tables(file); });
  bool flag = false;
  int integer = 0;
  double number = 0.0;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  OptionSet set;
  set.flag("flag", flag, "help"), set.integer("integer", integer, "help", 0, 9);
  set.number("number", number, "help", 0.0, 1.0);
  set.numbers("numbers", numbers, "help", 3, 0.0, 1.0), set.texts("texts", texts, "help");
  cli::apply_configuration(file, {"train", "label"}, "train", set.options(), {});
  set.validate();
}

void parse_message(ByteSpan message, const std::string& type, RosSerialization serialization) {
  if (!is_image_type(type)) {
    parse_camera_info(message, serialization);
    return;
  }
  const RosImage image = parse_image(message, type, serialization);
  if (!image.is_compressed) decode(image);  // else it is OpenCV that parses
}

/// The first byte tells the type and the serialization of the message behind it.
void parse_selected_message(const fs::path&, ByteSpan bytes) {
  if (bytes.empty()) return;
  static const std::string types[] = {"sensor_msgs/Image", "sensor_msgs/CompressedImage",
                                      "sensor_msgs/CameraInfo"};
  const auto serialization = bytes[0] & 1 ? RosSerialization::cdr : RosSerialization::ros1;
  tolerate([&] { parse_message(bytes.subspan(1), types[(bytes[0] >> 1) % 3], serialization); });
}

template <class File>
void parse_messages(const fs::path& path, ByteSpan) {
  File file(path);
  for (const auto& topic : file.topics())
    for (const BagMessage& message : topic.second.messages)
      tolerate([&] {
        parse_message(file.read(message), topic.second.type, topic.second.serialization);
      });
}

void parse_numpy(const fs::path& file, ByteSpan) {
  const NumpyArray array = read_numpy_array(file);
  tolerate([&] { to_depth(array); });
}

/// Converts the frames of a file, at least one, as import_glove() does.
void use_glove_file(const GloveFile& glove) {
  if (glove.time_s.empty()) return;
  require(glove.values.size() == glove.time_s.size() * glove.taxels(), "frames are not complete");
  counts_of(glove, value_scale(glove, false));
  const GloveTimes times = glove_times(glove);
  require(std::ranges::is_sorted(times.time_s), "times are out of order");
  require(times.sequence.size() == times.frames.size(), "a frame has no number");
}

void parse_track(const fs::path& file, ByteSpan) {
  const TrackFile track = read_track(file);
  estimate_white_sigma(track.track);
  read_flights(file, track);
}

std::vector<FuzzTarget> make_targets() {
  std::vector<FuzzTarget> targets;
  for (const GloveProtocol& protocol : glove_protocols())
    targets.push_back({"glove_" + protocol.name, "", [&protocol](const fs::path&, ByteSpan bytes) {
                         parse_glove(protocol, bytes);
                       }});
  const auto add = [&](const char* name, const char* extension, auto parse) {
    targets.push_back({name, extension, parse});
  };
  add("log", ".log", parse_log);
  add("session", "", [](auto&, ByteSpan bytes) { parse_session(bytes); });
  add("glove_config", ".json", [](auto& file, ByteSpan) { read_glove_config(file); });
  add("own_glove", ".toml",
      [](auto& file, ByteSpan bytes) { parse_glove(read_glove_protocol(file), bytes); });
  add("model", ".safetensors", parse_model);
  add("calibration", ".json", [](auto& file, ByteSpan) { read_calibration(file); });
  add("camera_yaml", ".yaml", [](auto& file, ByteSpan) { read_calibration(file); });
  add("camchain", ".yaml", [](auto& file, ByteSpan) { read_camchain(file); });
  add("intrinsics", ".json",
      [](auto& file, ByteSpan) { stated_counts_per_m(file), read_intrinsics(file, 640, 480); });
  add("matrix", ".txt", [](auto& file, ByteSpan) { read_intrinsics(file, 640, 480); });
  add("toml", ".toml", parse_toml);
  add("matlab", ".mat", [](auto& file, ByteSpan) {
    tolerate([&] { read_matlab_depth(file); });
    GloveFileOptions options;
    options.rate_hz = 15.0;
    tolerate([&] { read_glove_matlab(file, options); });
  });
  add("npy", ".npy", parse_numpy);
  add("npz", ".npz", [](auto& file, ByteSpan) { read_numpy_archive(file); });
  add("bag", ".bag", parse_messages<BagFile>);
  add("mcap", ".mcap", parse_messages<McapFile>);
  add("message", "", parse_selected_message);
  add("track", ".csv", parse_track);
  add("glove_table", ".csv",
      [](auto& file, ByteSpan) { use_glove_file(read_glove_table(file, {})); });
  add("glove_npz", ".npz",
      [](auto& file, ByteSpan) { use_glove_file(read_glove_numpy(file, {})); });
  add("iso_time", "", [](auto&, ByteSpan bytes) {
    const auto time_s = parse_iso_time({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    require(!time_s || std::isfinite(*time_s), "a time is not finite");
  });
  add("clips", ".csv", [](auto& file, ByteSpan) { read_clips(file, {0.0, 100.0, 0.0}, "ball"); });
  add("tum_list", ".txt",
      [](auto& file, ByteSpan) { read_tum_list(file.parent_path(), file.filename().c_str()); });
  return targets;
}

}  // namespace

const std::vector<FuzzTarget>& fuzz_targets() {
  static const std::vector<FuzzTarget> targets = make_targets();
  return targets;
}

void run_fuzz_target(const FuzzTarget& target, ByteSpan bytes) {
  static const ScratchFolder folder;
  const fs::path file = folder.path() / ("input" + target.extension);
  if (!target.extension.empty())
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  try {
    target.parse(file, bytes);
  } catch (const Error& error) {
    require(error.code() == ExitCode::data || error.code() == ExitCode::usage, error.what());
  }
}

}  // namespace touchtrace
