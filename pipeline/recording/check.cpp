#include "pipeline/recording/check.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/intrinsics_check.h"
#include "pipeline/recording/label_check.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

std::size_t count_usable_clips(const std::vector<Clip>& clips) {
  return static_cast<std::size_t>(std::count_if(
      clips.begin(), clips.end(), [](const Clip& clip) { return !clip.object_fell; }));
}

nlohmann::json describe_clips(const std::vector<Clip>& clips) {
  nlohmann::json objects = nlohmann::json::object();
  double seconds = 0.0;
  for (const auto& clip : clips) {
    seconds += clip.end_s - clip.start_s;
    objects[clip.object] = objects.value(clip.object, 0) + 1;
  }
  return {{"count", clips.size()},
          {"dropped", clips.size() - count_usable_clips(clips)},
          {"seconds", seconds},
          {"objects", objects}};
}

nlohmann::json describe_glove(const GloveStream& glove, const TactileCheck& tactile,
                              const std::vector<Clip>& clips) {
  const GloveInfo& info = glove.info;
  nlohmann::json json = to_json(measure_stream_timing(glove.sequence, glove.host_time_s, clips));
  json.update({{"name", info.name},
               {"rows", info.rows},
               {"cols", info.cols},
               {"bits", info.bits},
               {"polarity", info.polarity},
               {"nominal_hz", info.rate_hz}});
  json.update(to_json(tactile));
  if (glove.inertial) {
    const InertialStream& unit = *glove.inertial;
    json["inertial"] = to_json(measure_stream_timing(unit.sequence, unit.host_time_s, clips));
    json["inertial"]["nominal_hz"] = unit.rate_hz;
  }
  return json;
}

nlohmann::json describe_camera(const RecordingReader& reader) {
  const Recording& recording = reader.recording();
  const CameraTimes& times = recording.camera_times;
  nlohmann::json json =
      to_json(measure_stream_timing(times.sequence, times.host_time_s, recording.clips));
  json.update({{"width", recording.camera.width},
               {"height", recording.camera.height},
               {"nominal_hz", recording.camera.rate_hz},
               {"depth", reader.has_depth()},
               {"color_images", reader.color_images()},
               {"depth_images", reader.depth_images()},
               {"masks", reader.masked_color_images().size()},
               {"background_frames", reader.background_frames()},
               {"board_views", reader.board_views()}});
  return json;
}

std::optional<std::string> unpaired_warning(const RecordingReader& reader) {
  const std::size_t images = reader.depth_images(),
                    pairs = reader.recording().camera_times.frames();
  if (pairs >= images) return std::nullopt;
  return fmt::format("{} of {} depth images have no colour image at their time and are skipped",
                     images - pairs, images);
}

/// Returns the faults of all images, one text per group.
std::vector<std::string> check_images(const RecordingReader& reader) {
  const std::size_t frames = reader.recording().camera_times.frames(),
                    background = reader.background_frames(), board = reader.board_views();
  std::vector<std::string> faults;
  Progress progress("checking images", frames + background + board);
  const auto check_group = [&](std::size_t count, auto read) {
    std::vector<std::size_t> damaged;
    std::string first;
    for (std::size_t i = 0; i < count; ++i) {
      try {
        (reader.*read)(i);
      } catch (const Error& error) {
        if (damaged.empty()) first = error.what();
        damaged.push_back(i);
      }
      progress.advance();
    }
    if (damaged.size() == 1) faults.push_back(first);
    if (damaged.size() > 1)
      faults.push_back(fmt::format("{} (and images {})", first,
                                   fmt::join(damaged.begin() + 1, damaged.end(), ", ")));
  };
  check_group(frames, &RecordingReader::read_camera_frame);
  check_group(background, &RecordingReader::read_background);
  check_group(board, &RecordingReader::read_board_view);
  return faults;
}

nlohmann::json describe_quality(const LabelledBody& body) {
  const auto fraction = [&](std::uint8_t bit) {
    const auto count = std::count_if(body.quality.begin(), body.quality.end(),
                                     [bit](std::uint8_t quality) { return (quality & bit) != 0; });
    return static_cast<double>(count) /
           std::max<double>(1.0, static_cast<double>(body.quality.size()));
  };
  return {{"lost_share", fraction(quality_lost)},
          {"follows_share", fraction(quality_follows_hand)},
          {"gap_share", fraction(quality_gap)}};
}

}  // namespace

void require_usable(const std::vector<std::string>& missing, const std::string& name) {
  if (missing.empty()) return;
  throw data_error(fmt::format("{} cannot be used: {}", name, fmt::join(missing, "; ")),
                   "`touchtrace check` lists contents and which commands can use them");
}

bool FileCheck::is_usable() const {
  return faults.empty() && std::any_of(missing.begin(), missing.end(),
                                       [](const auto& command) { return command.second.empty(); });
}

std::vector<std::string> glove_warnings(const Recording& recording) {
  constexpr double max_rate_difference = 0.05;
  std::vector<std::string> warnings;
  for (const auto& glove : recording.gloves) {
    const auto warn = [&](const std::string& warning) {
      warnings.push_back(fmt::format("glove '{}': {}", glove.info.name, warning));
    };
    std::ranges::for_each(check_tactile(glove).warnings(), warn);
    const double rate_hz = measured_rate_hz(glove, recording.clips);
    if (std::abs(rate_hz / glove.info.rate_hz - 1.0) > max_rate_difference)
      warn(fmt::format("frames arrive at {:.4g} Hz, rate_hz is {:.4g}", rate_hz,
                       glove.info.rate_hz));
  }
  return warnings;
}

FileCheck check_recording(const RecordingReader& reader, bool images, bool has_calibration) {
  const Recording& recording = reader.recording();
  FileCheck check;
  if (images) check.faults = check_images(reader);
  check.contents = {{"schema", h5::schema_of(reader.path())},   {"activity", recording.activity},
                    {"clips", describe_clips(recording.clips)}, {"gloves", nlohmann::json::array()},
                    {"camera", describe_camera(reader)},        {"truth", reader.has_truth()},
                    {"provenance", recording.provenance}};
  for (const auto& glove : recording.gloves) {
    const TactileCheck tactile = check_tactile(glove);
    check.contents["gloves"].push_back(describe_glove(glove, tactile, recording.clips));
    for (const auto& fault : tactile.faults())
      check.faults.push_back(fmt::format("glove '{}': {}", glove.info.name, fault));
  }
  std::ranges::move(glove_warnings(recording), std::back_inserter(check.warnings));
  std::ranges::move(implausible_intrinsics(recording.camera), std::back_inserter(check.warnings));
  if (const auto unpaired = unpaired_warning(reader)) check.warnings.push_back(*unpaired);
  for (std::size_t i = 0; i < recording.clips.size(); ++i)
    for (const auto& fault : box_faults(recording.clips[i], recording))
      check.warnings.push_back(fmt::format("clip {} cannot be labelled: {}", i, fault));
  check.missing = {{"calibrate", missing_for_calibration(reader)},
                   {"label", missing_for_labelling(reader, has_calibration)},
                   {"train", missing_for_training(recording)}};
  return check;
}

FileCheck check_labels(const Labels& labels) {
  FileCheck check;
  check.contents = {{"schema", labels_schema},
                    {"activity", labels.activity},
                    {"clips", describe_clips(labels.clips)},
                    {"labels", labels.time_s.size()},
                    {"camera_frames", labels.raw.time_s.size()},
                    {"hand", describe_quality(labels.hand)},
                    {"object", describe_quality(labels.object)},
                    {"summary", labels.summary},
                    {"provenance", labels.provenance}};
  check.warnings = label_warnings(labels);
  auto& missing = check.missing["train"];
  std::size_t good = 0;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i)
    good += labels.hand.quality[i] == quality_good && labels.object.quality[i] == quality_good;
  if (good == 0) missing.emplace_back("no label of good quality");
  if (std::ranges::all_of(labels.glove_frame, [](auto frame) { return frame < 0; }))
    missing.emplace_back("no label of a glove's frame");
  return check;
}

FileCheck check_file(const std::filesystem::path& path, bool images, bool has_calibration) {
  if (h5::schema_of(path) == labels_schema) return check_labels(read_labels(path));
  RecordingReader::validate(path);
  return check_recording(RecordingReader(path), images, has_calibration);
}

nlohmann::json to_json(const FileCheck& check) {
  return {{"holds", check.contents},
          {"faults", check.faults},
          {"warnings", check.warnings},
          {"lacks", check.missing},
          {"good", check.is_usable()}};
}

}  // namespace touchtrace
