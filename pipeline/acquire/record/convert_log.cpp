#include "pipeline/acquire/record/convert_log.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/baseline.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/recording/frame_pairs.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Reads the log as far as its description, which is stored twice.
SessionInfo read_session(LogReader& reader, const fs::path& log) {
  while (const auto record = reader.next())
    if (record->kind == RecordKind::description) return parse_session(record->payload);
  throw data_error(fmt::format("{} has no description of its recording", log.string()),
                   "record again: the log ends before its first frame, or its start is damaged");
}

/// True if the stamp continues a stream.
bool follows(const FrameStamp& stamp, const std::vector<std::uint64_t>& sequence,
             const std::vector<double>& host_time_s) {
  if (!std::isfinite(stamp.host_time_s) || !std::isfinite(stamp.device_time_s)) return false;
  return sequence.empty() ||
         (stamp.sequence > sequence.back() && stamp.host_time_s >= host_time_s.back());
}

/// Recording that grows record by record.
class RecordingBuilder {
 public:
  RecordingBuilder(const SessionInfo& session, const fs::path& output, bool overwrite)
      : session_(session),
        camera_(session.camera.value_or(CameraInfo{})),
        writer_(output, camera_, overwrite) {}

  /// False if the record cannot be used.
  bool add(const LogRecord& record) {
    switch (record.kind) {
      case RecordKind::description:
        return true;
      case RecordKind::glove_frame:
        return session_.glove && add_glove_frame(record.payload);
      case RecordKind::color_image:
        return add_image(record.payload, 3, camera_.width, camera_.height, color_, color_times_,
                         &RecordingWriter::append_color);
      case RecordKind::depth_image:
        return add_image(record.payload, 1, camera_.depth_image_width(),
                         camera_.depth_image_height(), depth_, depth_times_,
                         &RecordingWriter::append_depth);
      case RecordKind::reconnection:
        segments_.push_back(glove_.frames());
        return true;
    }
    return false;
  }

  Recording finish();
  std::size_t color_images() const { return color_times_.frames(); }
  std::size_t depth_images() const { return depth_times_.frames(); }

 private:
  bool add_glove_frame(std::span<const std::uint8_t> payload) {
    FrameStamp stamp;
    const auto taxels = static_cast<std::size_t>(session_.glove->taxels());
    if (!from_payload(payload, taxels, stamp, counts_) ||
        !follows(stamp, glove_.sequence, glove_.host_time_s))
      return false;
    glove_.sequence.push_back(stamp.sequence);
    glove_.host_time_s.push_back(stamp.host_time_s);
    glove_.counts.insert(glove_.counts.end(), counts_.begin(), counts_.end());
    return true;
  }

  template <class Value>
  bool add_image(std::span<const std::uint8_t> payload, std::size_t channels, int width, int height,
                 std::vector<Value>& values, CameraTimes& times,
                 void (RecordingWriter::*append)(const std::vector<Value>&)) {
    FrameStamp stamp;
    const auto size = channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (!session_.camera || !from_payload(payload, size, stamp, values) ||
        !follows(stamp, times.sequence, times.host_time_s) ||
        (times.frames() > 0 && stamp.device_time_s < times.device_time_s.back()))
      return false;
    times.sequence.push_back(stamp.sequence);
    times.host_time_s.push_back(stamp.host_time_s);
    times.device_time_s.push_back(stamp.device_time_s);
    (writer_.*append)(values);
    return true;
  }

  std::vector<Clip> clips() const;
  void finish_glove(const std::vector<Clip>& clips);

  SessionInfo session_;
  CameraInfo camera_;
  RecordingWriter writer_;
  GloveStream glove_;
  CameraTimes color_times_, depth_times_;
  std::vector<std::size_t> segments_;  ///< first glove frame after each reconnection
  std::vector<std::uint16_t> counts_, depth_;
  std::vector<std::uint8_t> color_;
};

/// One clip for each connection of the glove with two frames; without a glove, all images.
std::vector<Clip> RecordingBuilder::clips() const {
  std::vector<Clip> clips;
  const auto& times_s = glove_.frames() > 0         ? glove_.host_time_s
                        : depth_times_.frames() > 0 ? depth_times_.host_time_s
                                                    : color_times_.host_time_s;
  const double period_s = 1.0 / (glove_.frames() > 0 ? session_.glove->rate_hz : camera_.rate_hz);
  std::vector<std::size_t> starts = segments_;
  starts.insert(starts.begin(), 0);
  starts.push_back(times_s.size());
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    const std::size_t first = starts[i], last = starts[i + 1];
    if (last < first + 2) continue;
    // Frames were measured before they arrived, by less than their jitter: a clip that started at
    // the first arrival would lose this frame.
    const double start_s = times_s[first] - 0.5 * period_s;
    double end_s = times_s[last - 1] + period_s;
    if (last < times_s.size()) end_s = std::min(end_s, times_s[last] - 0.5 * period_s);
    if (end_s > start_s) clips.push_back({start_s, end_s, session_.object, false, {}, {}});
  }
  return clips;
}

void RecordingBuilder::finish_glove(const std::vector<Clip>& clips) {
  glove_.info = *session_.glove;
  const auto taxels = static_cast<std::size_t>(glove_.info.taxels());
  glove_.info.baseline_counts = session_.glove->baseline_counts.empty()
                                    ? resting_baseline(glove_, session_.rest_s)
                                    : session_.glove->baseline_counts;
  glove_.info.mask.assign(taxels, 1);
  glove_.info.taxel_position_m.assign(3 * taxels, std::numeric_limits<float>::quiet_NaN());
  const double rate_hz = measure_stream_timing(glove_.sequence, glove_.host_time_s, clips).rate_hz;
  if (std::isfinite(rate_hz) && rate_hz > 0.0) glove_.info.rate_hz = rate_hz;
}

Recording RecordingBuilder::finish() {
  if (glove_.frames() + color_times_.frames() + depth_times_.frames() == 0)
    throw data_error("the log has no frames",
                     "check that the glove or camera sends data, and --protocol");
  Recording recording;
  recording.activity = session_.activity;
  recording.epoch_unix_s = session_.epoch_unix_s;
  recording.provenance = session_.provenance;
  recording.clips = clips();
  recording.camera = camera_;
  recording.color_times = color_times_;
  recording.camera_times = depth_times_.frames() > 0 ? depth_times_ : color_times_;
  if (depth_times_.frames() > 0)
    recording.camera.rate_hz = rate_of(depth_times_.host_time_s, camera_.rate_hz);
  if (glove_.frames() > 0) {
    finish_glove(recording.clips);
    recording.gloves.push_back(std::move(glove_));
  }
  writer_.finish(recording);
  return recording;
}

LogConversion summarize(const Recording& recording, const LogDamage& damage) {
  LogConversion summary{damage};
  summary.clips = recording.clips.size();
  if (!recording.clips.empty())
    summary.duration_s = recording.clips.back().end_s - recording.clips.front().start_s;
  if (recording.gloves.empty()) return summary;
  const GloveStream& glove = recording.gloves[0];
  summary.glove_frames = glove.frames();
  summary.lost_glove_frames =
      measure_stream_timing(glove.sequence, glove.host_time_s, recording.clips).lost;
  return summary;
}

void report(const LogConversion& conversion, const fs::path& log) {
  const LogDamage& damage = conversion.damage;
  if (damage.torn_bytes > 0)
    Progress::warn(fmt::format("{} ends with a torn record of {} bytes, which is skipped",
                               log.string(), damage.torn_bytes));
  if (!damage.is_torn_only())
    Progress::warn(fmt::format("{} is damaged: {} records and {} bytes are skipped", log.string(),
                               damage.lost_records, damage.damaged_bytes));
  if (conversion.unusable_records > 0)
    Progress::warn(
        fmt::format("{} records of {} are skipped: unknown kind, wrong size or wrong order",
                    conversion.unusable_records, log.string()));
}

}  // namespace

std::string LogConversion::text() const {
  return fmt::format("{} glove frames ({} lost), {} colour and {} depth images, {} clips, {:.1f} s",
                     glove_frames, lost_glove_frames, color_images, depth_images, clips,
                     duration_s);
}

nlohmann::json to_json(const LogConversion& c) {
  return {{"glove_frames", c.glove_frames},
          {"lost_glove_frames", c.lost_glove_frames},
          {"color_images", c.color_images},
          {"depth_images", c.depth_images},
          {"clips", c.clips},
          {"duration_s", c.duration_s},
          {"log",
           {{"torn_bytes", c.damage.torn_bytes},
            {"damaged_bytes", c.damage.damaged_bytes},
            {"lost_records", c.damage.lost_records},
            {"unusable_records", c.unusable_records}}}};
}

LogConversion convert_log(const fs::path& log, const fs::path& output, bool overwrite) {
  LogReader reader(log);
  RecordingBuilder builder(read_session(reader, log), output, overwrite);
  std::uint64_t unusable = 0;
  Progress progress("converting the log", reader.size());
  for (std::uint64_t position = reader.position(); const auto record = reader.next();) {
    unusable += !builder.add(*record);
    progress.advance(reader.position() - std::exchange(position, reader.position()));
  }
  LogConversion conversion = summarize(builder.finish(), reader.damage());
  conversion.unusable_records = unusable;
  conversion.color_images = builder.color_images();
  conversion.depth_images = builder.depth_images();
  report(conversion, log);
  return conversion;
}

}  // namespace touchtrace
