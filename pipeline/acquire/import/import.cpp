#include "pipeline/acquire/import/import.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/background.h"
#include "pipeline/acquire/import/clip_file.h"
#include "pipeline/acquire/import/images/frame_numbers.h"
#include "pipeline/acquire/import/stream_copy.h"
#include "pipeline/recording/frame_pairs.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr double default_rate_hz = 30.0;  // of a single image
constexpr double max_rate_hz = 1000.0;
constexpr double max_clock_s = 5e5;  // half of what a recording may have

void require_consistent(const ImportOptions& o) {
  if (o.camera.registered && o.camera.no_registered)
    throw usage_error("--registered and --no-registered contradict each other",
                      "leave out one of them");
  if (!o.background.empty() && !o.background_frames.empty())
    throw usage_error("--background and --background-frames cannot be combined",
                      "leave out one of them");
  if (o.mask_ids.hand == o.mask_ids.object)
    throw usage_error(fmt::format("hand and object have the same mask id, {}", o.mask_ids.hand),
                      "give --hand-id and --object-id");
}

/// Times above `min_s`, by default Unix times, become seconds since the first one.
RecordedTime since_start(RecordedTime time, double min_s = min_unix_s) {
  if (time.first_s > min_s) {
    time.epoch_s = time.first_s;
    time.first_s -= time.epoch_s, time.last_s -= time.epoch_s;
  }
  return time;
}

/// Interval of all images.
RecordedTime recorded_time(const ImportSource& source, double rate_hz) {
  RecordedTime time{source.color.images.front().host_time_s,
                    source.color.images.back().host_time_s};
  if (!source.depth.images.empty()) {
    time.first_s = std::min(time.first_s, source.depth.images.front().host_time_s);
    time.last_s = std::max(time.last_s, source.depth.images.back().host_time_s);
  }
  time.last_s += 1.0 / rate_hz;
  return since_start(time);
}

void require_different_times(const SourceStream& stream, const char* kind) {
  const auto& images = stream.images;
  if (images.size() < 2 || images.front().host_time_s < images.back().host_time_s) return;
  throw data_error(fmt::format("all {} {} images have the time {:g} s", images.size(), kind,
                               images.front().host_time_s),
                   "remove or correct the file with the times, or give --rate HZ without it");
}

double plausible_rate_hz(const ImportSource& source) {
  const auto& stream = source.depth.images.empty() ? source.color : source.depth;
  const double rate_hz = rate_of(host_times_s(stream), default_rate_hz);
  if (rate_hz > max_rate_hz)
    throw data_error(fmt::format("the stamps say {:.3g} images per second", rate_hz),
                     "check the file with the times: stamps are times in seconds, not durations");
  return rate_hz;
}

/// Everything except cameras, gloves and stamps.
Recording describe_recording(const RecordedTime& time, const ImportOptions& options,
                             const Provenance& provenance) {
  Recording recording;
  recording.activity = options.activity;
  recording.epoch_unix_s = time.epoch_s;
  recording.provenance = provenance;
  recording.clips = {{time.first_s, time.last_s, options.object, false, {}, {}}};
  if (!options.clips.empty()) recording.clips = read_clips(options.clips, time, options.object);
  return recording;
}

/// Copies both streams in order of time, so that a bag is read once from its start to its end.
void copy_streams(StreamCopy& color, StreamCopy& depth, std::size_t num_images) {
  Progress progress("importing images", num_images);
  while (!color.is_finished() || !depth.is_finished()) {
    const bool is_color_next =
        depth.is_finished() || (!color.is_finished() && color.next_time_s() <= depth.next_time_s());
    (is_color_next ? color : depth).copy_next();
    progress.advance();
  }
}

void require_mostly_good(std::size_t skipped, std::size_t all, const char* kind) {
  if (2 * skipped > all)
    throw data_error(fmt::format("{} of {} {} cannot be used", skipped, all, kind),
                     "see the warnings above");
}

void require_mostly_good(const StreamCopy& copy, const char* kind) {
  require_mostly_good(copy.num_skipped(), copy.num_skipped() + copy.copied().size(), kind);
}

void warn_of_repeats(const StreamCopy& copy, const char* kind) {
  constexpr double max_repeated = 0.02;
  const std::size_t repeated = copy.num_repeated(), all = copy.copied().size();
  if (static_cast<double>(repeated) > max_repeated * static_cast<double>(all))
    Progress::warn(
        fmt::format("{} of {} {} equal the one before them: bodies seem to be at rest "
                    "there; record at the camera's own rate",
                    repeated, all, kind));
}

/// Reads masks and reports damaged ones.
class MaskFiles {
 public:
  explicit MaskFiles(const MaskIds& ids) : reader_(ids) {}

  std::optional<std::vector<std::uint8_t>> try_read(const MaskFile& file, cv::Size size) {
    ++num_files_;
    try {
      return reader_.read(file, size);
    } catch (const std::exception& error) {
      if (++num_skipped_ <= max_reported)
        Progress::warn(fmt::format("skipped mask {}: {}", file.any().string(), error.what()));
      return std::nullopt;
    }
  }
  void finish() const {
    require_mostly_good(num_skipped_, num_files_, "masks");
    if (num_skipped_ > max_reported)
      Progress::warn(fmt::format("skipped {} masks in all", num_skipped_));
    reader_.require_ids();
  }

 private:
  static constexpr std::size_t max_reported = 5;
  InstanceMaskReader reader_;
  std::size_t num_files_ = 0, num_skipped_ = 0;
};

void append_masks(RecordingWriter& writer, const std::map<std::size_t, MaskFile>& files,
                  const MaskIds& ids, const StreamCopy& color, cv::Size size) {
  Progress progress("importing masks", files.size());
  MaskFiles masks(ids);
  for (const auto& [image, file] : files) {
    progress.advance();
    if (!color.copied().contains(image)) continue;
    if (const auto mask = masks.try_read(file, size))
      writer.append_mask(color.copied().at(image), *mask);
  }
  masks.finish();
}

void append_background(RecordingWriter& writer, const ImportOptions& options,
                       const ImportSource& source, const SourceCamera& camera) {
  if (!options.background_frames.empty())
    append_background(writer, source, camera, parse_frame_range(options.background_frames));
  if (options.background.empty()) return;
  SourceOptions any_rate = options.source;
  if (any_rate.rate_hz == 0.0) any_rate.rate_hz = 1.0;
  const ImportSource background = open_source(options.background, any_rate);
  if (background.depth.images.empty())
    throw data_error(fmt::format("{} has no depth images", options.background),
                     "background needs colour and depth");
  append_background(writer, background, camera, {0, background.depth.images.size() - 1});
}

/// Adds the glove to the summary.
nlohmann::json with_glove(nlohmann::json summary, const Recording& recording) {
  if (recording.gloves.empty()) return summary;
  const GloveStream& glove = recording.gloves[0];
  summary["glove"] = {{"frames", glove.frames()},        {"rows", glove.info.rows},
                      {"cols", glove.info.cols},         {"rate_hz", glove.info.rate_hz},
                      {"bits", glove.info.bits},         {"polarity", glove.info.polarity},
                      {"start_s", glove.host_time_s[0]}, {"end_s", glove.host_time_s.back()}};
  return summary;
}

nlohmann::json summarize(const Recording& recording, const StreamCopy& color,
                         const StreamCopy& depth) {
  const CameraInfo& camera = recording.camera;
  return {{"color_images", color.copied().size()},
          {"depth_images", depth.copied().size()},
          {"skipped", color.num_skipped() + depth.num_skipped()},
          {"width", camera.width},
          {"height", camera.height},
          {"depth_width", camera.depth_image_width()},
          {"depth_height", camera.depth_image_height()},
          {"depth_unit_m", camera.depth_unit_m},
          {"registered", camera.is_registered},
          {"intrinsics", camera.color_camera.has_value()},
          {"rate_hz", camera.rate_hz},
          {"clips", recording.clips.size()}};
}

/// Options of the glove, whose frames have the images' rate if they have no times.
GloveOptions glove_options(const ImportOptions& options) {
  GloveOptions glove = options.glove;
  glove.layout.rate_hz = options.source.rate_hz;
  return glove;
}

/// Recording of a glove without a camera.
nlohmann::json import_glove_alone(const fs::path& output, const ImportOptions& options,
                                  const Provenance& provenance, bool overwrite) {
  const Stopwatch stopwatch;
  auto [glove, epoch_unix_s] = import_glove(glove_options(options));
  const RecordedTime time =
      since_start({glove.host_time_s.front(), glove.host_time_s.back() + 1.0 / glove.info.rate_hz},
                  max_clock_s);
  Recording recording = describe_recording(time, options, provenance);
  if (epoch_unix_s > 0.0)
    recording.epoch_unix_s = epoch_unix_s + time.epoch_s;
  else if (time.epoch_s <= min_unix_s)
    recording.epoch_unix_s = 0.0;  // since a computer's start
  move_to_clock(glove, time, options.glove.offset_s);
  if (options.clips.empty()) recording.clips = clips_between_pauses(glove, options.object);
  recording.gloves.push_back(std::move(glove));
  stopwatch.stop(recording.provenance);
  RecordingWriter(output, recording.camera, overwrite).finish(recording);
  return with_glove({{"clips", recording.clips.size()}}, recording);
}

}  // namespace

nlohmann::json import_recording(const fs::path& path, const fs::path& output,
                                const ImportOptions& options, const Provenance& provenance,
                                bool overwrite) {
  require_consistent(options);
  if (path.empty()) return import_glove_alone(output, options, provenance, overwrite);
  const Stopwatch stopwatch;
  ImportSource source = open_source(path, options.source);
  for (auto& image : source.depth.images) image.host_time_s += options.camera.depth_offset_s;
  require_different_times(source.color, "colour"), require_different_times(source.depth, "depth");
  require_pairs(source), check_numbers(source, options.source.rate_hz);
  SourceCamera camera = describe_camera(path, source, options.camera);
  camera.info.rate_hz = plausible_rate_hz(source);
  const RecordedTime time = recorded_time(source, camera.info.rate_hz);
  Recording recording = describe_recording(time, options, provenance);
  recording.camera = camera.info;
  if (!options.glove.file.empty()) {
    auto [glove, epoch_unix_s] = import_glove(glove_options(options));
    for (double& time_s : glove.host_time_s) time_s += epoch_unix_s;
    recording.gloves.push_back(std::move(glove));
    move_to_clock(recording.gloves[0], time, options.glove.offset_s);
  }
  const auto masks = options.masks.empty() ? std::map<std::size_t, MaskFile>{}
                                           : mask_files(options.masks, source.color.images);
  RecordingWriter writer(output, camera.info, overwrite);
  append_background(writer, options, source, camera);
  StreamCopy color(source.color, camera.color, recording.epoch_unix_s,
                   [&](const cv::Mat& image) { writer.append_color(rgb_values(image)); });
  StreamCopy depth(source.depth, camera.depth, recording.epoch_unix_s, [&](const cv::Mat& image) {
    writer.append_depth(camera.depth_scale.counts(image));
  });
  copy_streams(color, depth, source.color.images.size() + source.depth.images.size());
  require_mostly_good(color, "colour images"), require_mostly_good(depth, "depth images");
  warn_of_repeats(color, "colour images"), warn_of_repeats(depth, "depth images");
  append_masks(writer, masks, options.mask_ids, color, camera.color.size);
  recording.color_times = color.times();
  recording.camera_times = depth.copied().empty() ? recording.color_times : depth.times();
  stopwatch.stop(recording.provenance);
  writer.finish(recording);
  return with_glove(summarize(recording, color, depth), recording);
}

}  // namespace touchtrace
