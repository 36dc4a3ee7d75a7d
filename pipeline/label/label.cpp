#include "pipeline/label/label.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/label/camera_calibration.h"
#include "pipeline/label/learn/learn_scene.h"
#include "pipeline/label/learn/mask_boxes.h"
#include "pipeline/label/mask_use.h"
#include "pipeline/label/observe/color_gains.h"
#include "pipeline/label/preview/contact_sheet.h"
#include "pipeline/label/states/contact_latency.h"
#include "pipeline/label/states/lost_clips.h"
#include "pipeline/label/states/states.h"
#include "pipeline/label/states/summary.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/label/states/touch_latency.h"
#include "pipeline/label/track/box_centre.h"
#include "pipeline/label/track/track_clips.h"
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

/// Adds the uncertainty of the objects' centres according to the clips' boxes.
void add_box_uncertainty(const SceneModel& scene, const std::vector<ClipFrames>& clips,
                         std::vector<ClipTrack>& tracks) {
  const Camera& color = scene.segmenter->color_camera();
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks[i].object_centre_sigma_m = std::hypot(
        tracks[i].object_centre_sigma_m, box_centre_sigma_m(color, clips[i].object, clips, tracks));
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

/// Camera times at which the depth images were taken.
Timeline depth_timeline(const Recording& recording, const RgbdCalibration& calibration,
                        const LabelOptions& options) {
  auto timeline = align(recording);
  if (!options.camera_latency_s.empty())
    timeline.set_latency(options.camera_latency_s[0], options.camera_latency_s[1]);
  for (double& time_s : timeline.camera_time_s) time_s += calibration.depth_delay_s;
  return timeline;
}

FrameSource with_masks(FrameSource frames, MaskUse use) {
  if (use == MaskUse::none) frames.masked_frames.clear();
  if (use == MaskUse::hand_only) frames.only_masked_body = mask_hand;
  if (use == MaskUse::object_only) frames.only_masked_body = mask_object;
  return frames;
}

/// Moves all times of labels to `by_s` earlier.
void advance(Labels& labels, double by_s) {
  for (auto* times_s : {&labels.time_s, &labels.raw.time_s})
    for (double& time_s : *times_s) time_s -= by_s;
  for (auto& flight : labels.summary["flights"])
    for (const char* event : {"release_s", "landing_s"})
      flight[event] = flight[event].get<double>() - by_s;
}

/// One labelling: learn_and_track(), smooth(), labels(), in this order.
class LabelRun {
 public:
  LabelRun(const Recording& recording, const FrameSource& recorded,
           const std::optional<RgbdCalibration>& given, const LabelOptions& options)
      : recording_(recording),
        recorded_(recorded),
        options_(options),
        calibration_(camera_calibration(given, recording.camera)),
        gravity_m_per_s2_(gravity(recording.camera, options)),
        timeline_(depth_timeline(recording, calibration_, options)),
        clips_(boxed_clips(recording, recorded)) {
    require_usable_clip(clips_);
  }

  void learn_and_track();
  /// `on_refusal` gets the measured positions before an exception.
  void smooth(const std::function<void(const Labels&)>& on_refusal);
  Labels labels() const;

 private:
  void smooth_bodies();
  std::optional<LatencyEstimate> estimate_latency() const;
  /// Corrects the timeline by the latency that the glove shows, if it shows one.
  void correct_latency();
  ErrorModel errors() const { return {calibration_, timeline_.latency_sigma_s}; }

  const Recording& recording_;
  const FrameSource& recorded_;
  const LabelOptions& options_;
  RgbdCalibration calibration_;
  Eigen::Vector3d gravity_m_per_s2_;
  Timeline timeline_;
  std::vector<ClipFrames> clips_;
  SceneModel scene_;
  MaskUse mask_use_ = MaskUse::none;
  std::vector<ClipTrack> tracks_;
  SmoothedBodies bodies_;
  double late_s_ = 0.0;     ///< times of tracks_ and bodies_ minus those of timeline_
  nlohmann::json seconds_;  ///< by stage
};

void LabelRun::learn_and_track() {
  mask_use_ = choose_masks(recorded_, recording_.camera.width, clips_, options_.observer);
  const auto frames = with_masks(normalized(recorded_, clips_), mask_use_);
  const Stopwatch learning;
  scene_ = learn_scene(calibration_, recording_.camera, frames, clips_,
                       mask_use_ == MaskUse::all_frames, options_.num_threads);
  require_usable_clip(clips_);
  seconds_["learn_scene"] = learning.wall_seconds();
  const Stopwatch tracking;
  tracks_ = track_clips(scene_, frames, clips_, timeline_.camera_time_s, gravity_m_per_s2_,
                        find_tracker(options_.tracker), options_.num_threads);
  seconds_["track"] = tracking.wall_seconds(), seconds_["track_cpu"] = tracking.cpu_seconds();
}

void LabelRun::smooth_bodies() {
  bodies_ = label::smooth_bodies(tracks_, gravity_m_per_s2_,
                                 options_.no_flights ? Flights::none : Flights::find,
                                 options_.num_threads);
}

std::optional<LatencyEstimate> LabelRun::estimate_latency() const {
  if (!timeline_.glove || !options_.camera_latency_s.empty()) return std::nullopt;
  if (timeline_.latency_s + std::sqrt(3.0) * timeline_.latency_sigma_s > max_latency_s)
    return std::nullopt;  // a slow camera's may be beyond what is looked for
  const GloveStream& glove = recording_.gloves.front();
  if (auto by_catches = latency_from_catches(glove, timeline_, bodies_.object.tracks))
    return by_catches;
  return latency_from_touch(glove, timeline_, label_times(recording_, timeline_), tracks_,
                            bodies_.hand.tracks, gravity_m_per_s2_);
}

void LabelRun::correct_latency() {
  const auto latency = estimate_latency();
  if (!latency) return;
  Progress::report(
      fmt::format("latency of the camera: {:.0f} +- {:.0f} ms, by {} (without: {:.0f} +- {:.0f})",
                  1e3 * latency->latency_s, 1e3 * latency->sigma_s, latency->source,
                  1e3 * timeline_.latency_s, 1e3 * timeline_.latency_sigma_s));
  late_s_ = latency->latency_s - timeline_.latency_s;
  timeline_.set_latency(latency->latency_s, latency->sigma_s);
}

void LabelRun::smooth(const std::function<void(const Labels&)>& on_refusal) {
  const auto measured = on_refusal ? tracks_ : std::vector<ClipTrack>{};
  const auto require_clip = [&] {
    if (on_refusal && std::ranges::none_of(clips_, &ClipFrames::is_usable))
      on_refusal(measured_alone(recording_, measured, errors()));
    require_usable_clip(clips_);
  };
  drop_lost_clips(clips_, tracks_);
  require_clip();
  drop_objects_outside_boxes(scene_.segmenter->color_camera(), clips_, tracks_);
  add_box_uncertainty(scene_, clips_, tracks_);
  const Stopwatch smoothing;
  smooth_bodies();
  if (raise_sigmas(tracks_, bodies_)) smooth_bodies();
  correct_latency();
  drop_unsmoothed_clips(clips_, tracks_, bodies_);
  require_clip();
  seconds_["smooth"] = smoothing.wall_seconds();
}

Labels LabelRun::labels() const {
  Labels labels;
  labels.activity = recording_.activity;
  labels.clips = recording_.clips;
  auto times = label_times(recording_, timeline_);
  for (LabelTime& time : times) time.time_s += late_s_;
  resample(times, tracks_, bodies_, errors(), labels);
  labels.raw = raw_track(tracks_, bodies_, errors());
  labels.summary = summarize(scene_, timeline_, clips_, tracks_, bodies_, labels);
  advance(labels, late_s_);
  labels.summary["tracker"] = options_.tracker;
  labels.summary["observer"] = name_of(mask_use_);
  labels.summary["error_sources"] = error_source_names;
  labels.summary["latency_s"] = timeline_.latency_s;
  labels.summary["latency_sigma_s"] = timeline_.latency_sigma_s;
  labels.summary["gravity_m_per_s2"] = {gravity_m_per_s2_.x(), gravity_m_per_s2_.y(),
                                        gravity_m_per_s2_.z()};
  labels.summary["seconds"] = seconds_;
  const LabelOverlay overlay(recording_, calibration_, labels);
  labels.contact_sheet_jpeg = contact_sheet_jpeg(overlay, recorded_, options_.num_threads);
  return labels;
}

void warn_of_low_rate(const CameraInfo& camera) {
  if (camera.rate_hz < min_rate_hz)
    Progress::warn(fmt::format(
        "at {:.3g} Hz bodies move far from image to image and may be exchanged: look at "
        "the labels with --preview",
        camera.rate_hz));
}

/// Warns if the object's centre may as well be outside the object.
void warn_of_uncertain_object(const nlohmann::json& summary) {
  if (!summary["object_sigma_m"].is_number()) return;
  const double sigma_m = std::sqrt(3.0) * summary["object_sigma_m"].get<double>();
  for (const auto& [object, shape] : summary["object_shape"].items()) {
    const double radius_m =
        shape.contains("radius_m")
            ? shape["radius_m"].get<double>()
            : Eigen::Vector3d(shape["half_extents_m"].get<std::array<double, 3>>().data()).norm();
    if (sigma_m > radius_m)
      Progress::warn(fmt::format(
          "the centre of '{}' is uncertain by {:.0f} mm, more than its radius of {:.0f} mm: its "
          "colours may be those of other things; look at the labels with --preview, give masks",
          object, 1e3 * sigma_m, 1e3 * radius_m));
  }
}

}  // namespace

Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const std::optional<RgbdCalibration>& calibration,
                       const LabelOptions& options,
                       const std::function<void(const Labels&)>& on_refusal) {
  LabelRun run(recording, frames, calibration, options);
  warn_of_low_rate(recording.camera);
  run.learn_and_track();
  run.smooth(on_refusal);
  auto labels = run.labels();
  warn_of_uncertain_object(labels.summary);
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
