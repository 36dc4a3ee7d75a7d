#include "pipeline/label/label.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/board/opencv_threads.h"
#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "pipeline/label/box_tracker.h"
#include "pipeline/label/boxed_middle.h"
#include "pipeline/label/flights.h"
#include "pipeline/label/follow.h"
#include "pipeline/label/learn_scene.h"
#include "pipeline/label/states.h"
#include "pipeline/label/timeline.h"
#include "pipeline/recording/check.h"

namespace touchtrace::label {
namespace {

constexpr double enough_found =
    0.5;  // of all frames; less is a failure of the set-up, not of a frame

Eigen::Vector3d gravity(const CameraInfo& camera) {
  return {camera.gravity[0], camera.gravity[1], camera.gravity[2]};
}

void require_background(const FrameSource& frames) {
  if (frames.background_frames == 0)
    throw data_error("the recording has no background frames: nothing can be segmented",
                     "record a few frames of the scene without the person first");
}

std::vector<ClipFrames> usable_clips(const Recording& recording, const Timeline& timeline) {
  auto clips = clip_frames(recording, timeline);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (recording.clips[i].object_fell) clips[i].count = 0;
    if (clips[i].count > 0 && (clips[i].hand_box.empty() || clips[i].object_box.empty()))
      throw data_error(fmt::format("clip {} has no boxes on hand and object", i),
                       "mark both in the clip's first camera frame (hand_box and object_box)");
  }
  return clips;
}

SeenFrame see(const SceneModel& scene, const FrameSource& frames, const TrackerKind& kind,
              const ClipFrames& clip, std::size_t index) {
  SeenFrame seen{frames.camera_frame(index), {}, {}};
  seen.surface = scene.see(seen.frame, clip.object);
  const auto& camera = scene.segmenter.color_camera();
  if (kind.create) seen.image = masked_image(seen.frame, seen.surface, camera.width, camera.height);
  return seen;
}

/// Clips are the parallel work; threads that find none left see frames ahead for those that do.
std::vector<ClipTrack> follow_all(const SceneModel& scene, const FrameSource& frames,
                                  const std::vector<ClipFrames>& clips, const Timeline& timeline,
                                  const Recording& recording, const LabelOptions& options) {
  const auto& kind = find_tracker(options.tracker);
  std::size_t total = 0;
  for (const auto& clip : clips) total += clip.count;
  Progress progress("following hand and object", total);
  std::vector<ClipTrack> tracks(clips.size());
  FramesAhead ahead(clips, [&](const ClipFrames& clip, std::size_t index) {
    progress.advance();
    return see(scene, frames, kind, clip, index);
  });
  const OpenCvThreads one_thread_per_clip(1);
  const std::size_t helpers = thread_count(options.threads);
  parallel_for(clips.size() + helpers, options.threads, [&](std::size_t i) {
    if (i >= clips.size()) return ahead.help();
    FramesAhead::Reader reader(ahead, i);
    if (clips[i].count > 0)
      tracks[i] =
          follow(scene, reader, clips[i], timeline.camera_time_s, gravity(recording.camera), kind);
  });
  return tracks;
}

/// Adds what the clips' boxes tell of the objects' middles.
void believe_boxes(const SceneModel& scene, const std::vector<ClipFrames>& clips,
                   std::vector<ClipTrack>& tracks) {
  const Camera& color = scene.segmenter.color_camera();
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks[i].object_middle_sigma_m =
        std::hypot(tracks[i].object_middle_sigma_m,
                   boxed_middle_sigma_m(color, clips[i].object, clips, tracks));
}

struct Shares {
  double hand_lost = 0.0, object_lost = 0.0, object_follows = 0.0;
  int restarts = 0;
};

Shares shares_of(const std::vector<ClipTrack>& tracks) {
  Shares shares;
  double frames = 0.0;
  for (const auto& track : tracks) {
    frames += static_cast<double>(track.time_s.size());
    shares.restarts += track.restarts;
    for (const auto& o : track.hand) shares.hand_lost += !o.found;
    for (const auto& o : track.object)
      shares.object_lost += !o.found, shares.object_follows += o.follows_hand;
  }
  for (double* share : {&shares.hand_lost, &shares.object_lost, &shares.object_follows})
    *share /= std::max(1.0, frames);
  return shares;
}

void require_found(const Shares& shares) {
  for (const auto& [body, lost] :
       {std::pair{"hand", shares.hand_lost}, {"object", shares.object_lost}})
    if (lost > 1.0 - enough_found)
      throw data_error(fmt::format("the {} was lost in {:.0f} % of all frames", body, 100.0 * lost),
                       "check the boxes, the calibration and that the background was recorded "
                       "without the person");
}

std::vector<std::string> tracker_names() {
  std::vector<std::string> names;
  for (const auto& kind : tracker_kinds()) names.push_back(kind.name);
  return names;
}

nlohmann::json clock_summary(const ClockFit& clock) {
  return {{"offset_s", clock.offset_s},
          {"drift_ppm", clock.drift_ppm()},
          {"drift_deviation_ppm", 1e6 * clock.rate_sigma},
          {"mean_delay_s", clock.mean_delay_s}};
}

nlohmann::json noise_summary(const SmoothedTracks& smoothed) {
  return {{"jerk_density_m2_per_s5", smoothed.noise.jerk_density},
          {"measurement_scale", smoothed.noise.measurement_scale},
          {"correlated_scale", smoothed.noise.correlated_scale}};
}

nlohmann::json flights_summary(const SmoothedTracks& smoothed) {
  auto flights = nlohmann::json::array();
  for (std::size_t clip = 0; clip < smoothed.tracks.size(); ++clip)
    for (const auto& flight : smoothed.tracks[clip].flights)
      flights.push_back(
          {{"clip", clip}, {"release_s", flight.release_s}, {"landing_s", flight.landing_s}});
  return flights;
}

nlohmann::json shapes_summary(const SceneModel& scene) {
  nlohmann::json shapes;
  for (const auto& [object, shape] : scene.object_shape) {
    shapes[object] = {{"unevenness_m", shape.unevenness_m},
                      {"middle_sigma_m", shape.middle_sigma_m}};
    if (shape.body) {
      const Eigen::Vector3d half = shape.body->half_extents_m();
      shapes[object]["half_extents_m"] = {half.x(), half.y(), half.z()};
      shapes[object]["edge_radius_m"] = shape.body->radius_m;
      shapes[object]["core"] = shape.body->core == Core::box ? "box" : "cylinder";
    } else {
      shapes[object]["radius_m"] = shape.radius_m;
    }
  }
  return shapes;
}

nlohmann::json summarize(const LabelOptions& options, const SceneModel& scene,
                         const Timeline& timeline, const Shares& shares,
                         const SmoothedBodies& bodies) {
  return {
      {"tracker", options.tracker},
      {"hand_lost_share", shares.hand_lost},
      {"object_lost_share", shares.object_lost},
      {"object_follows_share", shares.object_follows},
      {"tracker_restarts", shares.restarts},
      {"band_m", scene.band_m},
      {"object_shape", shapes_summary(scene)},
      {"clocks",
       {{"camera", clock_summary(timeline.camera)},
        {"glove", clock_summary(timeline.glove)},
        {"label_time", "middle of the glove's scan"},
        {"unobservable", "the least latency of glove and camera stays in their offsets"}}},
      {"noise", {{"hand", noise_summary(bodies.hand)}, {"object", noise_summary(bodies.object)}}},
      {"flights", flights_summary(bodies.object)}};
}

}  // namespace

void describe(OptionSet& set, LabelOptions& o) {
  set.choice("tracker", o.tracker, "component: fastest", tracker_names());
  set.integer("threads", o.threads, "clips in parallel; 0: one per core", 0, 1024);
}

Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const RgbdCalibration& calibration, const LabelOptions& options) {
  auto timeline = align(recording);
  // places come from depth images
  for (double& time_s : timeline.camera_time_s) time_s += calibration.depth_delay_s;
  require_background(frames);
  const auto clips = usable_clips(recording, timeline);
  const Stopwatch learning;
  const auto scene = learn_scene(calibration, recording.camera, frames, clips, options.threads);
  const double learning_s = learning.wall_seconds();
  const Stopwatch following;
  auto tracks = follow_all(scene, frames, clips, timeline, recording, options);
  believe_boxes(scene, clips, tracks);
  const double following_s = following.wall_seconds(), following_cpu_s = following.cpu_seconds();
  const auto shares = shares_of(tracks);
  require_found(shares);
  const Stopwatch smoothing;
  const double falling = falling_part(tracks, gravity(recording.camera));
  const auto bodies = smooth_bodies(tracks, gravity(recording.camera),
                                    falling > falling_part_of_bounces, options.threads);

  Labels labels;
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  resample(glove_frames(recording, timeline), tracks, bodies, 1.0 / recording.camera.rate_hz,
           CalibrationError(calibration), labels);
  labels.raw = raw_track(tracks);
  labels.summary = summarize(options, scene, timeline, shares, bodies);
  labels.summary["object_falling_part"] = falling;
  labels.summary["object_bounces"] = falling > falling_part_of_bounces;
  labels.summary["seconds"] = {{"learn_scene", learning_s},
                               {"follow", following_s},
                               {"follow_cpu", following_cpu_s},
                               {"smooth", smoothing.wall_seconds()}};
  return labels;
}

Labels label_recording(const RecordingReader& reader, const RgbdCalibration& calibration,
                       const LabelOptions& options) {
  require_usable(missing_for_labelling(reader), "the recording");
  return label_recording(reader.recording(), frames_of(reader), calibration, options);
}

FrameSource frames_of(const RecordingReader& reader) {
  return {[&reader](std::size_t i) { return reader.read_camera_frame(i); },
          [&reader](std::size_t i) { return reader.read_background(i); },
          reader.background_frames()};
}

}  // namespace touchtrace::label
