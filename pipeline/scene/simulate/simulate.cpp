#include "pipeline/scene/simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/base/interrupt.h"
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

  int clips() const { return clips_; }

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

}  // namespace

/// Clips, glove and truth of a recording.
struct SimulatedStreams {
  explicit SimulatedStreams(const SceneOptions& scene)
      : options(scene),
        camera(make_camera(scene)),
        clock(make_camera_clock(scene)),
        truth(start_truth(scene, camera, clock)) {
    recording.activity = options.activity;
    recording.camera = camera_info(camera, options);
  }

  void append_clip(const ClipMotion& motion, int clip) {
    const ClipSpan span = clip_span(options, clip);
    recording.clips.push_back(
        {span.start_s, span.end_s(), options.object.name, motion.object_fell, {}, {}});
    append_glove(recording.gloves, motion.glove);
    append_truth(truth, motion, options.object, clip, camera.color_from_world);
  }

  SceneOptions options;
  RgbdCamera camera;
  CameraClock clock;
  Recording recording;
  Truth truth;
};

namespace {

Progress clip_progress(const SceneOptions& options, int clips) {
  return Progress("simulate " + options.activity + " " + options.object.name,
                  static_cast<std::uint64_t>(clips));
}

/// Appends images to a recording; one is stored while the next is rendered.
class ImageStore {
 public:
  using Append = void (RecordingWriter::*)(const RgbdFrame&);

  explicit ImageStore(RecordingWriter& writer) : writer_(writer) {}

  void append(RgbdFrame frame, Append append) {
    throw_if_interrupted();
    wait();
    storing_ = std::async(std::launch::async,
                          [this, append, frame = std::move(frame)] { (writer_.*append)(frame); });
  }
  void wait() {
    if (storing_.valid()) storing_.get();
  }

 private:
  RecordingWriter& writer_;
  std::future<void> storing_;
};

void store_clip(Video& video, const ClipMotion& motion, int clip, Recording& recording,
                ImageStore& store) {
  for (const std::uint64_t sequence : video.append_frames(motion, clip, recording))
    store.append(video.camera_frame(motion, sequence), &RecordingWriter::append_camera_frame);
}

void store_still_views(Video& video, ImageStore& store) {
  for (std::size_t i = 0; i < background_frames; ++i)
    store.append(video.background(i), &RecordingWriter::append_background);
  for (std::size_t i = 0; i < video.board_views(); ++i)
    store.append(video.board_view(i), &RecordingWriter::append_board_view);
  store.wait();
}

SimulationSummary summarize(const Recording& recording, std::size_t board_views) {
  SimulationSummary summary;
  summary.clips = recording.clips.size();
  summary.dropped_clips =
      static_cast<std::size_t>(std::ranges::count(recording.clips, true, &Clip::object_fell));
  summary.glove_frames = recording.gloves.front().frames();
  summary.camera_frames = recording.camera_times.frames();
  summary.board_views = board_views;
  summary.wall_seconds = recording.provenance.wall_seconds;
  summary.cpu_seconds = recording.provenance.cpu_seconds;
  return summary;
}

}  // namespace

SimulationSummary simulate_recording(const SceneOptions& options, Runtime* runtime,
                                     const std::filesystem::path& output, bool overwrite,
                                     Provenance provenance) {
  const Stopwatch stopwatch;
  SimulatedStreams streams(options);
  Recording& recording = streams.recording;
  RecordingWriter writer(output, recording.camera, overwrite);
  ImageStore store(writer);
  std::optional<Video> video;
  if (runtime) video.emplace(*runtime, streams.camera, streams.clock, options, recording.board);
  MotionQueue motions(options);
  Progress progress = clip_progress(options, motions.clips());
  for (int clip = 0; clip < motions.clips(); ++clip, progress.advance()) {
    const ClipMotion motion = motions.next();
    streams.append_clip(motion, clip);
    if (video) store_clip(*video, motion, clip, recording, store);
  }
  if (video) store_still_views(*video, store);
  writer.write_truth(streams.truth);
  stopwatch.stop(provenance);
  recording.provenance = std::move(provenance);
  writer.finish(recording);
  return summarize(recording, video ? video->board_views() : 0);
}

struct RenderedScene::State {
  State(const SceneOptions& options, Runtime& runtime)
      : streams(options),
        video(runtime, streams.camera, streams.clock, options, streams.recording.board) {
    MotionQueue queue(options);
    Progress progress = clip_progress(options, queue.clips());
    for (int clip = 0; clip < queue.clips(); ++clip, progress.advance()) {
      motions.push_back(queue.next());
      streams.append_clip(motions.back(), clip);
      frame_clip.resize(
          frame_clip.size() + video.append_frames(motions.back(), clip, streams.recording).size(),
          motions.size() - 1);
    }
  }

  Stopwatch stopwatch;
  SimulatedStreams streams;
  std::vector<ClipMotion> motions;
  std::vector<std::size_t> frame_clip;  ///< [camera frames] index of the clip
  std::mutex rendering;
  Video video;
};

RenderedScene::RenderedScene(const SceneOptions& options, Runtime& runtime)
    : state_(std::make_unique<State>(options, runtime)) {}

RenderedScene::~RenderedScene() = default;

const Recording& RenderedScene::recording() const { return state_->streams.recording; }

std::size_t RenderedScene::background_frames() const { return scene::background_frames; }

std::size_t RenderedScene::board_views() const { return state_->video.board_views(); }

RgbdFrame RenderedScene::camera_frame(std::size_t index) const {
  const std::lock_guard lock(state_->rendering);
  return state_->video.camera_frame(state_->motions[state_->frame_clip[index]],
                                    recording().camera_times.sequence[index]);
}

RgbdFrame RenderedScene::background(std::size_t index) const {
  const std::lock_guard lock(state_->rendering);
  return state_->video.background(index);
}

RgbdFrame RenderedScene::board_view(std::size_t index) const {
  const std::lock_guard lock(state_->rendering);
  return state_->video.board_view(index);
}

SimulationSummary RenderedScene::write(const std::filesystem::path& output, bool overwrite,
                                       Provenance provenance) const {
  Recording recording = state_->streams.recording;
  recording.camera_times = {};
  for (Clip& clip : recording.clips) clip.hand_box = clip.object_box = {};
  RecordingWriter writer(output, recording.camera, overwrite);
  writer.write_truth(state_->streams.truth);
  state_->stopwatch.stop(provenance);
  recording.provenance = std::move(provenance);
  writer.finish(recording);
  return summarize(recording, 0);
}

}  // namespace touchtrace::scene
