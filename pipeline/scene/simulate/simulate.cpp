#include "pipeline/scene/simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>
#include <optional>
#include <thread>

#include "engine/base/progress.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/simulate/clip.h"
#include "pipeline/scene/simulate/truth.h"
#include "pipeline/scene/simulate/video.h"

namespace touchtrace::scene {
namespace {

/// Clip motions in order, computed a few clips ahead on other threads.
class MotionQueue {
 public:
  explicit MotionQueue(const SceneOptions& options)
      : options_(options), clips_(clip_count(options)) {
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) start_next();
  }

  ClipMotion next() {
    ClipMotion motion = ahead_.front().get();
    ahead_.pop_front();
    start_next();
    return motion;
  }

 private:
  void start_next() {
    if (started_ == clips_) return;
    const int clip = started_++;
    ahead_.push_back(std::async(std::launch::async, [options = options_, clip] {
      return simulate_clip(options, clip, clip_span(options, clip).start_s);
    }));
  }

  SceneOptions options_;
  int clips_, started_ = 0;
  std::deque<std::future<ClipMotion>> ahead_;
};

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_inertial(InertialStream& to, const InertialStream& from) {
  append(to.sequence, from.sequence);
  append(to.host_time_s, from.host_time_s);
  append(to.specific_force_m_per_s2, from.specific_force_m_per_s2);
  append(to.angular_velocity_rad_per_s, from.angular_velocity_rad_per_s);
  append(to.orientation_wxyz, from.orientation_wxyz);
}

void append_glove(std::vector<GloveStream>& gloves, const GloveStream& glove) {
  if (gloves.empty()) {
    gloves.push_back(glove);
    return;
  }
  GloveStream& whole = gloves.front();
  append(whole.sequence, glove.sequence);
  append(whole.host_time_s, glove.host_time_s);
  append(whole.counts, glove.counts);
  if (glove.inertial) append_inertial(*whole.inertial, *glove.inertial);
}

SimulationSummary summarize(const Recording& recording) {
  SimulationSummary summary;
  summary.clips = recording.clips.size();
  summary.dropped_clips =
      static_cast<std::size_t>(std::ranges::count(recording.clips, true, &Clip::object_fell));
  summary.glove_frames = recording.gloves.front().frames();
  summary.camera_frames = recording.camera_times.frames();
  return summary;
}

}  // namespace

SimulationSummary simulate_recording(const SceneOptions& options, Runtime* runtime,
                                     const std::filesystem::path& output, bool overwrite,
                                     Provenance provenance) {
  const Stopwatch stopwatch;
  const RgbdCamera camera = make_camera(options);
  const CameraClock clock = make_camera_clock(options);
  Recording recording;
  recording.activity = options.activity;
  recording.camera = camera_info(camera, options);
  RecordingWriter writer(output, recording.camera, overwrite);
  std::optional<Video> video;
  if (runtime) video.emplace(*runtime, camera, clock, options, writer);

  const int clips = clip_count(options);
  Truth truth = start_truth(options, camera, clock);
  Progress progress("simulate " + options.activity + " " + options.object.name,
                    static_cast<std::uint64_t>(clips));
  MotionQueue motions(options);
  for (int i = 0; i < clips; ++i) {
    const ClipMotion motion = motions.next();
    const ClipSpan span = clip_span(options, i);
    recording.clips.push_back(
        {span.start_s, span.end_s(), options.object.name, motion.object_fell, {}, {}});
    if (video) video->record_clip(motion, i, recording);
    append_glove(recording.gloves, motion.glove);
    append_truth(truth, motion, options.object, i, camera.color_from_world);
    progress.advance();
  }
  SimulationSummary summary = summarize(recording);
  if (video) summary.board_views = video->record_still_views(recording.board);
  writer.write_truth(truth);
  stopwatch.stop(provenance);
  summary.wall_seconds = provenance.wall_seconds, summary.cpu_seconds = provenance.cpu_seconds;
  recording.provenance = std::move(provenance);
  writer.finish(recording);
  return summary;
}

}  // namespace touchtrace::scene
