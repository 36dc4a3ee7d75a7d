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
#include "pipeline/label/camera_calibration.h"
#include "pipeline/label/clip_tracker.h"
#include "pipeline/label/contact_latency.h"
#include "pipeline/label/contact_sheet.h"
#include "pipeline/label/flights.h"
#include "pipeline/label/learn_scene.h"
#include "pipeline/label/lost_clips.h"
#include "pipeline/label/mask_boxes.h"
#include "pipeline/label/mask_use.h"
#include "pipeline/label/observe/color_gains.h"
#include "pipeline/label/states.h"
#include "pipeline/label/summary.h"
#include "pipeline/label/timeline.h"
#include "pipeline/recording/check.h"

namespace touchtrace::label {
namespace {

constexpr double min_rate_hz = 9.0;  // the paper's camera has 20 Hz

/// Gravity given, from the camera's accelerometer, or along the image's vertical axis.
Eigen::Vector3d gravity(const CameraInfo& camera, const LabelOptions& options) {
  if (options.gravity_m_per_s2.empty())
    return camera.gravity_m_per_s2.value_or(Eigen::Vector3d(0.0, 9.81, 0.0));
  const Eigen::Vector3d given(options.gravity_m_per_s2.data());
  if (given.isZero())
    throw usage_error("--gravity must not be 0 0 0", "without flights, pass --no-flights");
  return given;
}

/// Clips with boxes, drawn by a user or around a mask.
std::vector<ClipFrames> boxed_clips(const Recording& recording, const FrameSource& frames) {
  auto clips = clip_frames(recording);
  for (auto& clip : clips) {
    if (clip.is_usable() && !clip.has_boxes()) set_mask_boxes(frames, recording.camera.width, clip);
    if (clip.is_usable() && !clip.has_boxes())
      clip.problem =
          "no boxes, and no mask of both hand and object; run: touchtrace mark RECORDING";
  }
  return clips;
}

/// Frames with colours like those of the first usable clip's box frame.
FrameSource normalized(const FrameSource& frames, const std::vector<ClipFrames>& clips) {
  const auto first = std::ranges::find_if(clips, &ClipFrames::is_usable);
  const auto reference = std::make_shared<RgbdFrame>(frames.camera_frame(first->box_frame));
  auto result = frames;
  result.camera_frame = [read = frames.camera_frame, reference](std::size_t i) {
    auto frame = read(i);
    normalize_colors(color_gains(*reference, frame), frame);
    return frame;
  };
  return result;
}

SegmentedFrame segment(const SceneModel& scene, const FrameSource& frames, const TrackerKind& kind,
                       const ClipFrames& clip, std::size_t index) {
  SegmentedFrame result{frames.camera_frame(index), {}, {}};
  result.surface = scene.observer->observe(result.frame, clip.object);
  const auto& camera = scene.segmenter->color_camera();
  if (kind.create)
    result.image = masked_image(result.frame, result.surface, camera.width, camera.height);
  return result;
}

std::vector<TrackingPass> passes_of(const std::vector<ClipFrames>& clips) {
  std::vector<TrackingPass> passes;
  for (const auto& clip : clips) {
    if (!clip.is_usable()) continue;
    passes.push_back({&clip, false});
    if (clip.box_frame > clip.first) passes.push_back({&clip, true});
  }
  return passes;
}

/// Tracks clips in parallel. Threads without a pass segment frames for the others.
std::vector<ClipTrack> track_clips(const SceneModel& scene, const FrameSource& frames,
                                   const std::vector<ClipFrames>& clips, const Timeline& timeline,
                                   const Eigen::Vector3d& gravity_m_per_s2,
                                   const LabelOptions& options) {
  const auto& kind = find_tracker(options.tracker);
  const auto passes = passes_of(clips);
  std::size_t total = 0;
  for (const auto& pass : passes) total += pass.count();
  Progress progress("tracking hand and object", total);
  FramePrefetcher prefetcher(passes, [&](const ClipFrames& clip, std::size_t index) {
    progress.advance();
    return segment(scene, frames, kind, clip, index);
  });
  std::vector<ClipTrack> tracked(passes.size()), tracks(clips.size());
  const OpenCvThreads single_threaded(1);  // passes are the parallel work
  const std::size_t workers = thread_count(options.num_threads);
  parallel_for(passes.size() + workers, options.num_threads, [&](std::size_t i) {
    if (i >= passes.size()) return prefetcher.run_worker();
    FramePrefetcher::Reader reader(prefetcher, i);
    tracked[i] =
        track_pass(scene, reader, passes[i], timeline.camera_time_s, gravity_m_per_s2, kind);
  });
  for (std::size_t i = 0; i < passes.size(); ++i) {
    auto& track = tracks[static_cast<std::size_t>(passes[i].clip - clips.data())];
    track = passes[i].is_backward ? join(std::move(tracked[i]), track) : std::move(tracked[i]);
  }
  return tracks;
}

/// Adds the uncertainty of the objects' centres according to the clips' boxes.
void add_box_uncertainty(const SceneModel& scene, const std::vector<ClipFrames>& clips,
                         std::vector<ClipTrack>& tracks) {
  const Camera& color = scene.segmenter->color_camera();
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks[i].object_centre_sigma_m = std::hypot(
        tracks[i].object_centre_sigma_m, box_centre_sigma_m(color, clips[i].object, clips, tracks));
}

std::vector<std::string> tracker_names() {
  std::vector<std::string> names;
  for (const auto& kind : tracker_kinds()) names.push_back(kind.name);
  return names;
}

FlightSearch flight_search(const std::vector<ClipTrack>& tracks,
                           const Eigen::Vector3d& gravity_m_per_s2, const LabelOptions& options) {
  if (options.no_flights) return FlightSearch::none;
  return free_fall_fraction(tracks, gravity_m_per_s2) > min_bounce_fraction ? FlightSearch::bounces
                                                                            : FlightSearch::throws;
}

/// Corrects the times of timeline and tracks by the latency that catches show. False: they do not.
bool correct_latency(const Recording& recording, const SmoothedBodies& bodies, Timeline& timeline,
                     std::vector<ClipTrack>& tracks) {
  if (!timeline.glove) return false;
  const auto latency = estimate_latency(recording.gloves.front(), timeline, bodies.object.tracks);
  if (!latency) return false;
  Progress::report(fmt::format(
      "latency of the camera: {:.0f} +- {:.0f} ms, by {} catches (without them: {:.0f} +- {:.0f})",
      1e3 * latency->latency_s, 1e3 * latency->sigma_s, latency->num_catches,
      1e3 * timeline.latency_s, 1e3 * timeline.latency_sigma_s));
  for (ClipTrack& track : tracks)
    for (double& time_s : track.time_s) time_s -= latency->latency_s - timeline.latency_s;
  timeline.set_latency(latency->latency_s, latency->sigma_s);
  return true;
}

/// Measured positions of a recording that cannot be labelled.
Labels measured_alone(const Recording& recording, const std::vector<ClipTrack>& tracks,
                      const ErrorModel& errors) {
  SmoothedBodies unsmoothed;
  unsmoothed.hand.tracks.resize(tracks.size());
  unsmoothed.object.tracks.resize(tracks.size());
  Labels labels;
  labels.summary = nlohmann::json::object();
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  labels.raw = raw_track(tracks, unsmoothed, errors);
  return labels;
}

}  // namespace

Option& describe_tracker(OptionSet& set, LabelOptions& o) {
  return set.choice("tracker", o.tracker, "component: fastest", tracker_names());
}

void describe(OptionSet& set, LabelOptions& o) {
  describe_tracker(set, o);
  set.choice(
      "observer", o.observer,
      "what shows hand and object; auto: masks where there are some, colours elsewhere, or masks "
      "alone if half of the frames have one",
      {"auto", "depth-color", "masks"});
  set.flag("no-flights", o.no_flights, "the object never leaves the hand");
  set.numbers("gravity", o.gravity_m_per_s2,
              "gravity in the colour camera's frame [m/s^2]; default: recorded, else 0 9.81 0", 3,
              -100.0, 100.0)
      .value("X Y Z");
  set.integer("threads", o.num_threads, "clips in parallel; 0: one per core", 0, 1024);
}

Labels label_recording(const Recording& recording, const FrameSource& recorded,
                       const std::optional<RgbdCalibration>& given, const LabelOptions& options,
                       const std::function<void(const Labels&)>& on_refusal) {
  const auto calibration = camera_calibration(given, recording.camera);
  const Eigen::Vector3d down = gravity(recording.camera, options);
  auto timeline = align(recording);
  // positions come from depth images
  for (double& time_s : timeline.camera_time_s) time_s += calibration.depth_delay_s;
  if (recording.camera.rate_hz < min_rate_hz)
    Progress::warn(fmt::format(
        "at {:.3g} Hz bodies move far from image to image and may be exchanged: look at "
        "the labels with --preview",
        recording.camera.rate_hz));
  auto clips = boxed_clips(recording, recorded);
  require_usable_clip(clips);
  const auto mask_use = choose_masks(recorded, recording.camera.width, clips, options.observer);
  const bool use_masks = mask_use == MaskUse::all_frames;
  auto frames = normalized(recorded, clips);
  if (mask_use == MaskUse::none) frames.masked_frames.clear();
  if (mask_use == MaskUse::hand_only) frames.only_masked_body = mask_hand;
  if (mask_use == MaskUse::object_only) frames.only_masked_body = mask_object;
  const Stopwatch learning;
  const auto scene =
      learn_scene(calibration, recording.camera, frames, clips, use_masks, options.num_threads);
  require_usable_clip(clips);
  const double learning_s = learning.wall_seconds();
  const Stopwatch tracking;
  auto tracks = track_clips(scene, frames, clips, timeline, down, options);
  const auto measured = on_refusal ? tracks : std::vector<ClipTrack>{};
  const auto require_clip = [&] {
    if (on_refusal && std::ranges::none_of(clips, &ClipFrames::is_usable))
      on_refusal(measured_alone(recording, measured, {calibration, timeline.latency_sigma_s}));
    require_usable_clip(clips);
  };
  drop_lost_clips(clips, tracks);
  require_clip();
  add_box_uncertainty(scene, clips, tracks);
  const double tracking_s = tracking.wall_seconds(), tracking_cpu_s = tracking.cpu_seconds();
  const Stopwatch smoothing;
  const auto search = flight_search(tracks, down, options);
  auto bodies = smooth_bodies(tracks, down, search, options.num_threads);
  if (raise_sigmas(tracks, bodies))
    bodies = smooth_bodies(tracks, down, search, options.num_threads);
  if (search == FlightSearch::throws && correct_latency(recording, bodies, timeline, tracks))
    bodies = smooth_bodies(tracks, down, search, options.num_threads);
  drop_unsmoothed_clips(clips, tracks, bodies);
  require_clip();

  Labels labels;
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  const ErrorModel errors(calibration, timeline.latency_sigma_s);
  resample(label_times(recording, timeline), tracks, bodies, errors, labels);
  labels.raw = raw_track(tracks, bodies, errors);
  labels.summary = summarize(scene, timeline, clips, tracks, bodies, labels);
  labels.summary["tracker"] = options.tracker;
  labels.summary["observer"] = use_masks ? "masks" : "depth-color";
  labels.summary["error_sources"] = error_source_names;
  labels.summary["latency_s"] = timeline.latency_s;
  labels.summary["latency_sigma_s"] = timeline.latency_sigma_s;
  labels.summary["object_bounces"] = search == FlightSearch::bounces;
  labels.summary["gravity_m_per_s2"] = {down.x(), down.y(), down.z()};
  labels.summary["seconds"] = {{"learn_scene", learning_s},
                               {"track", tracking_s},
                               {"track_cpu", tracking_cpu_s},
                               {"smooth", smoothing.wall_seconds()}};
  const LabelOverlay overlay(recording, calibration, labels);
  labels.contact_sheet_jpeg = contact_sheet_jpeg(overlay, recorded);
  return labels;
}

Labels label_recording(const RecordingReader& reader,
                       const std::optional<RgbdCalibration>& calibration,
                       const LabelOptions& options,
                       const std::function<void(const Labels&)>& on_refusal) {
  require_usable(missing_for_labelling(reader, calibration.has_value()), reader.path());
  return label_recording(reader.recording(), frame_source(reader), calibration, options,
                         on_refusal);
}

FrameSource frame_source(const RecordingReader& reader) {
  return {[&reader](std::size_t i) { return reader.read_camera_frame(i); },
          [&reader](std::size_t i) { return reader.read_background(i); },
          reader.background_frames(), reader.masked_camera_frames()};
}

}  // namespace touchtrace::label
