#include "pipeline/recording/check.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

constexpr std::size_t fewest_board_views = 3;

std::size_t useful_clips(const std::vector<Clip>& clips) {
  return static_cast<std::size_t>(
      std::count_if(clips.begin(), clips.end(), [](const Clip& clip) { return !clip.dropped; }));
}

/// Frames in the fullest clip.
std::size_t most_frames_in_a_clip(const std::vector<Clip>& clips,
                                  const std::vector<double>& time_s) {
  std::ptrdiff_t most = 0;
  for (const auto& clip : clips)
    most = std::max(most, std::lower_bound(time_s.begin(), time_s.end(), clip.end_s) -
                              std::lower_bound(time_s.begin(), time_s.end(), clip.start_s));
  return static_cast<std::size_t>(most);
}

void require_clips(const Recording& recording, std::vector<std::string>& lacks) {
  if (recording.clips.empty())
    lacks.emplace_back("it has no clips");
  else if (useful_clips(recording.clips) == 0)
    lacks.emplace_back("the object fell in every clip");
}

void require_glove(const Recording& recording, std::vector<std::string>& lacks) {
  if (recording.gloves.empty())
    lacks.emplace_back("it has no glove");
  else if (most_frames_in_a_clip(recording.clips, recording.gloves[0].host_time_s) < 2)
    lacks.emplace_back("no clip holds two glove frames");
}

nlohmann::json describe_clips(const std::vector<Clip>& clips) {
  nlohmann::json objects = nlohmann::json::object();
  double seconds = 0.0;
  for (const auto& clip : clips) {
    seconds += clip.end_s - clip.start_s;
    objects[clip.object] = objects.value(clip.object, 0) + 1;
  }
  return {{"count", clips.size()},
          {"dropped", clips.size() - useful_clips(clips)},
          {"seconds", seconds},
          {"objects", objects}};
}

nlohmann::json describe_glove(const GloveStream& glove, const std::vector<Clip>& clips) {
  const GloveInfo& info = glove.info;
  nlohmann::json json = to_json(timing_of(glove.sequence, glove.host_time_s, clips));
  json.update({{"name", info.name},
               {"rows", info.rows},
               {"cols", info.cols},
               {"bits", info.bits},
               {"polarity", info.polarity},
               {"nominal_hz", info.rate_hz}});
  json.update(to_json(check_tactile(glove)));
  if (glove.inertial) {
    const InertialStream& unit = *glove.inertial;
    json["inertial"] = to_json(timing_of(unit.sequence, unit.host_time_s, clips));
    json["inertial"]["nominal_hz"] = unit.rate_hz;
  }
  return json;
}

nlohmann::json describe_camera(const RecordingReader& reader) {
  const Recording& recording = reader.recording();
  const CameraTimes& times = recording.camera_times;
  nlohmann::json json = to_json(timing_of(times.sequence, times.host_time_s, recording.clips));
  json.update({{"width", recording.camera.width},
               {"height", recording.camera.height},
               {"nominal_hz", recording.camera.rate_hz},
               {"depth", reader.has_depth()},
               {"background_frames", reader.background_frames()},
               {"board_views", reader.board_views()}});
  return json;
}

void read_all_images(const RecordingReader& reader) {
  const std::size_t frames = reader.recording().camera_times.frames();
  Progress progress("checking images", frames + reader.background_frames() + reader.board_views());
  for (std::size_t i = 0; i < frames; ++i, progress.advance()) reader.read_camera_frame(i);
  for (std::size_t i = 0; i < reader.background_frames(); ++i, progress.advance())
    reader.read_background(i);
  for (std::size_t i = 0; i < reader.board_views(); ++i, progress.advance())
    reader.read_board_view(i);
}

nlohmann::json describe_quality(const LabelledBody& body) {
  const auto share = [&](std::uint8_t bit) {
    const auto count = std::count_if(body.quality.begin(), body.quality.end(),
                                     [bit](std::uint8_t quality) { return (quality & bit) != 0; });
    return static_cast<double>(count) /
           std::max<double>(1.0, static_cast<double>(body.quality.size()));
  };
  return {{"lost_share", share(quality_lost)},
          {"follows_share", share(quality_follows)},
          {"gap_share", share(quality_gap)}};
}

}  // namespace

std::vector<std::string> lacks_for_calibrating(const RecordingReader& reader) {
  if (reader.board_views() >= fewest_board_views) return {};
  return {fmt::format("it has {} views of the board; calibrating needs {}", reader.board_views(),
                      fewest_board_views)};
}

std::vector<std::string> lacks_for_labelling(const RecordingReader& reader) {
  const Recording& recording = reader.recording();
  std::vector<std::string> lacks;
  require_clips(recording, lacks);
  require_glove(recording, lacks);
  if (recording.camera_times.frames() == 0)
    lacks.emplace_back("it has no camera images");
  else if (!reader.has_depth())
    lacks.emplace_back("its camera images have no depth");
  else if (most_frames_in_a_clip(recording.clips, recording.camera_times.host_time_s) < 2)
    lacks.emplace_back("no clip holds two camera images");
  return lacks;
}

std::vector<std::string> lacks_for_training(const Recording& recording) {
  std::vector<std::string> lacks;
  require_clips(recording, lacks);
  require_glove(recording, lacks);
  if (!recording.gloves.empty())
    for (auto& fault : check_tactile(recording.gloves[0]).faults())
      lacks.push_back(std::move(fault));
  return lacks;
}

void require_nothing_lacking(const std::vector<std::string>& lacks, const std::string& what) {
  if (lacks.empty()) return;
  std::string list;
  for (const auto& lack : lacks) list += (list.empty() ? "" : "; ") + lack;
  throw data_error(fmt::format("{} cannot be used for this: {}", what, list),
                   "`touchtrace check` says what a file holds and which verbs it serves");
}

bool FileCheck::good() const {
  return faults.empty() && std::any_of(lacks.begin(), lacks.end(),
                                       [](const auto& verb) { return verb.second.empty(); });
}

FileCheck check_recording(const RecordingReader& reader, bool images) {
  const Recording& recording = reader.recording();
  if (images) read_all_images(reader);
  FileCheck check;
  check.holds = {{"schema", recording_schema},
                 {"activity", recording.activity},
                 {"clips", describe_clips(recording.clips)},
                 {"gloves", nlohmann::json::array()},
                 {"camera", describe_camera(reader)},
                 {"truth", reader.has_truth()},
                 {"provenance", recording.provenance}};
  for (const auto& glove : recording.gloves) {
    check.holds["gloves"].push_back(describe_glove(glove, recording.clips));
    for (const auto& fault : check_tactile(glove).faults())
      check.faults.push_back(fmt::format("glove '{}': {}", glove.info.name, fault));
  }
  check.lacks = {{"calibrate", lacks_for_calibrating(reader)},
                 {"label", lacks_for_labelling(reader)},
                 {"train", lacks_for_training(recording)}};
  return check;
}

FileCheck check_labels(const Labels& labels) {
  FileCheck check;
  check.holds = {{"schema", labels_schema},
                 {"activity", labels.activity},
                 {"clips", describe_clips(labels.clips)},
                 {"labels", labels.time_s.size()},
                 {"camera_frames", labels.raw.time_s.size()},
                 {"hand", describe_quality(labels.hand)},
                 {"object", describe_quality(labels.object)},
                 {"summary", labels.summary},
                 {"provenance", labels.provenance}};
  auto& lacks = check.lacks["train"];
  std::size_t trusted = 0;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i)
    trusted += labels.hand.quality[i] == quality_good && labels.object.quality[i] == quality_good;
  if (trusted == 0) lacks.emplace_back("it has no label that can be trusted");
  return check;
}

FileCheck check_file(const std::filesystem::path& path, bool images) {
  if (h5::schema_of(path) == labels_schema) return check_labels(read_labels(path));
  return check_recording(RecordingReader(path), images);
}

nlohmann::json to_json(const FileCheck& check) {
  return {{"holds", check.holds},
          {"faults", check.faults},
          {"lacks", check.lacks},
          {"good", check.good()}};
}

}  // namespace touchtrace
