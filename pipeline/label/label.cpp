#include "pipeline/label/label.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/board/opencv_threads.h"
#include "engine/base/error.h"
#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "pipeline/label/box_centre.h"
#include "pipeline/label/box_tracker.h"
#include "pipeline/label/clip_tracker.h"
#include "pipeline/label/flights.h"
#include "pipeline/label/learn_scene.h"
#include "pipeline/label/matching.h"
#include "pipeline/label/states.h"
#include "pipeline/label/timeline.h"
#include "pipeline/recording/check.h"

namespace touchtrace::label {
namespace {

constexpr double min_found_fraction = 0.5;  // of all frames; less: the set-up is wrong

/// Gravity by the camera's accelerometer, or along the image's vertical axis.
Eigen::Vector3d gravity(const CameraInfo& camera) {
  return camera.gravity_m_per_s2.value_or(Eigen::Vector3d(0.0, 9.81, 0.0));
}

void require_background(const FrameSource& frames) {
  if (frames.background_frames == 0)
    throw data_error("recording has no background frames",
                     "record a few frames of the empty scene before the first clip");
}

std::vector<ClipFrames> usable_clips(const Recording& recording, const Timeline& timeline) {
  auto clips = clip_frames(recording, timeline);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (recording.clips[i].object_fell) clips[i].count = 0;
    if (clips[i].count > 0 && (clips[i].hand_box.empty() || clips[i].object_box.empty()))
      throw data_error(fmt::format("clip {} has no boxes on hand and object", i),
                       "draw both in the clip's first camera frame (hand_box and object_box)");
  }
  return clips;
}

SegmentedFrame segment(const SceneModel& scene, const FrameSource& frames, const TrackerKind& kind,
                       const ClipFrames& clip, std::size_t index) {
  SegmentedFrame result{frames.camera_frame(index), {}, {}};
  result.surface = scene.segment(result.frame, clip.object);
  const auto& camera = scene.segmenter.color_camera();
  if (kind.create)
    result.image = masked_image(result.frame, result.surface, camera.width, camera.height);
  return result;
}

/// Tracks clips in parallel. Threads without a clip segment frames for the others.
std::vector<ClipTrack> track_clips(const SceneModel& scene, const FrameSource& frames,
                                   const std::vector<ClipFrames>& clips, const Timeline& timeline,
                                   const Recording& recording, const LabelOptions& options) {
  const auto& kind = find_tracker(options.tracker);
  std::size_t total = 0;
  for (const auto& clip : clips) total += clip.count;
  Progress progress("tracking hand and object", total);
  std::vector<ClipTrack> tracks(clips.size());
  FramePrefetcher prefetcher(clips, [&](const ClipFrames& clip, std::size_t index) {
    progress.advance();
    return segment(scene, frames, kind, clip, index);
  });
  const OpenCvThreads single_threaded(1);  // clips are the parallel work
  const std::size_t workers = thread_count(options.num_threads);
  parallel_for(clips.size() + workers, options.num_threads, [&](std::size_t i) {
    if (i >= clips.size()) return prefetcher.run_worker();
    FramePrefetcher::Reader reader(prefetcher, i);
    if (clips[i].count > 0)
      tracks[i] = track_clip(scene, reader, clips[i], timeline.camera_time_s,
                             gravity(recording.camera), kind);
  });
  return tracks;
}

/// Adds the uncertainty of the objects' centres according to the clips' boxes.
void add_box_uncertainty(const SceneModel& scene, const std::vector<ClipFrames>& clips,
                         std::vector<ClipTrack>& tracks) {
  const Camera& color = scene.segmenter.color_camera();
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks[i].object_centre_sigma_m = std::hypot(
        tracks[i].object_centre_sigma_m, box_centre_sigma_m(color, clips[i].object, clips, tracks));
}

struct FrameStatistics {
  double hand_lost = 0.0, object_lost = 0.0, object_follows = 0.0;  ///< fractions of the frames
  int tracker_starts = 0;
};

FrameStatistics frame_statistics(const std::vector<ClipTrack>& tracks) {
  FrameStatistics statistics;
  double frames = 0.0;
  for (const auto& track : tracks) {
    frames += static_cast<double>(track.time_s.size());
    statistics.tracker_starts += track.tracker_starts;
    for (const auto& o : track.hand) statistics.hand_lost += !o.found;
    for (const auto& o : track.object)
      statistics.object_lost += !o.found, statistics.object_follows += o.follows_hand;
  }
  for (double* count : {&statistics.hand_lost, &statistics.object_lost, &statistics.object_follows})
    *count /= std::max(1.0, frames);
  return statistics;
}

void require_found(const FrameStatistics& statistics) {
  for (const auto& [body, lost] :
       {std::pair{"hand", statistics.hand_lost}, {"object", statistics.object_lost}})
    if (lost > 1.0 - min_found_fraction)
      throw data_error(fmt::format("{} lost in {:.0f} % of all camera frames", body, 100.0 * lost),
                       "check boxes and calibration, and that background frames show no person");
}

std::vector<std::string> tracker_names() {
  std::vector<std::string> names;
  for (const auto& kind : tracker_kinds()) names.push_back(kind.name);
  return names;
}

nlohmann::json clock_summary(const ClockFit& clock) {
  return {{"offset_s", clock.offset_s},
          {"drift_ppm", clock.drift_ppm()},
          {"drift_sigma_ppm", 1e6 * clock.rate_sigma},
          {"mean_delay_s", clock.mean_delay_s}};
}

nlohmann::json noise_summary(const SmoothedTracks& smoothed) {
  return {{"jerk_density_m2_per_s5", smoothed.noise.jerk_density},
          {"measurement_scale", smoothed.noise.measurement_scale},
          {"bandwidth_rad_per_s", smoothed.noise.bandwidth_rad_per_s}};
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
                      {"centre_sigma_m", shape.centre_sigma_m}};
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
                         const Timeline& timeline, const FrameStatistics& statistics,
                         const SmoothedBodies& bodies) {
  return {
      {"tracker", options.tracker},
      {"hand_lost_share", statistics.hand_lost},
      {"object_lost_share", statistics.object_lost},
      {"object_follows_share", statistics.object_follows},
      {"tracker_restarts", statistics.tracker_starts},
      {"band_m", scene.band_m},
      {"object_shape", shapes_summary(scene)},
      {"clocks",
       {{"camera", clock_summary(timeline.camera)},
        {"glove", clock_summary(timeline.glove)},
        {"label_time", "mid-scan time of the glove frame"},
        {"unobservable", "minimum latency of glove and camera, part of their offsets"}}},
      {"noise", {{"hand", noise_summary(bodies.hand)}, {"object", noise_summary(bodies.object)}}},
      {"flights", flights_summary(bodies.object)}};
}

}  // namespace

void describe(OptionSet& set, LabelOptions& o) {
  set.choice("tracker", o.tracker, "component: fastest", tracker_names());
  set.integer("threads", o.num_threads, "clips in parallel; 0: one per core", 0, 1024);
}

Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const RgbdCalibration& calibration, const LabelOptions& options) {
  auto timeline = align(recording);
  // positions come from depth images
  for (double& time_s : timeline.camera_time_s) time_s += calibration.depth_delay_s;
  require_background(frames);
  const auto clips = usable_clips(recording, timeline);
  const Stopwatch learning;
  const auto scene = learn_scene(calibration, recording.camera, frames, clips, options.num_threads);
  const double learning_s = learning.wall_seconds();
  const Stopwatch tracking;
  auto tracks = track_clips(scene, frames, clips, timeline, recording, options);
  add_box_uncertainty(scene, clips, tracks);
  const double tracking_s = tracking.wall_seconds(), tracking_cpu_s = tracking.cpu_seconds();
  const auto statistics = frame_statistics(tracks);
  require_found(statistics);
  const Stopwatch smoothing;
  const double falling = free_fall_fraction(tracks, gravity(recording.camera));
  const bool bounces = falling > min_bounce_fraction;
  const auto bodies =
      smooth_bodies(tracks, gravity(recording.camera), bounces, options.num_threads);

  Labels labels;
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  resample(glove_frames(recording, timeline), tracks, bodies, 1.0 / recording.camera.rate_hz,
           CalibrationError(calibration), labels);
  labels.raw = raw_track(tracks);
  labels.summary = summarize(options, scene, timeline, statistics, bodies);
  labels.summary["object_free_fall_fraction"] = falling;
  labels.summary["object_bounces"] = bounces;
  labels.summary["seconds"] = {{"learn_scene", learning_s},
                               {"track", tracking_s},
                               {"track_cpu", tracking_cpu_s},
                               {"smooth", smoothing.wall_seconds()}};
  return labels;
}

Labels label_recording(const RecordingReader& reader, const RgbdCalibration& calibration,
                       const LabelOptions& options) {
  require_usable(missing_for_labelling(reader, true), reader.path());
  require_matching(calibration, reader.recording().camera);
  return label_recording(reader.recording(), frame_source(reader), calibration, options);
}

FrameSource frame_source(const RecordingReader& reader) {
  return {[&reader](std::size_t i) { return reader.read_camera_frame(i); },
          [&reader](std::size_t i) { return reader.read_background(i); },
          reader.background_frames()};
}

}  // namespace touchtrace::label
