#include "pipeline/study/label_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/label/flights.h"
#include "pipeline/label/states.h"
#include "pipeline/label/timeline.h"
#include "pipeline/scene/camera/visible.h"
#include "pipeline/study/truth_samples.h"

namespace touchtrace::study {
namespace {

constexpr double exact_m = 1e-5, covered_s = 1.0, found_m = 0.060;

label::Observation exact(const Truth::Body& body, const TruthPlace& place) {
  label::Observation seen;
  seen.found = true;
  seen.position_m = interpolate(body.position_m, place);
  seen.sigma_m.setConstant(exact_m);
  return seen;
}

label::ClipTrack exact_track(const label::ClipFrames& frames, std::int32_t clip,
                             const std::vector<double>& camera_time_s, const Truth& truth) {
  label::ClipTrack track;
  for (std::size_t i = frames.first; i < frames.first + frames.count; ++i) {
    const auto place = find_place(truth, clip, camera_time_s[i]);
    if (!place) continue;
    track.time_s.push_back(camera_time_s[i]);
    track.hand.push_back(exact(truth.hand, *place));
    track.object.push_back(exact(truth.object, *place));
  }
  return track;
}

std::vector<label::ClipTrack> exact_tracks(const Recording& recording,
                                           const label::Timeline& timeline, const Truth& truth) {
  std::vector<label::ClipTrack> tracks;
  const auto clips = label::clip_frames(recording, timeline);
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks.push_back(
        recording.clips[i].dropped
            ? label::ClipTrack{}
            : exact_track(clips[i], static_cast<std::int32_t>(i), timeline.camera_time_s, truth));
  return tracks;
}

std::vector<Cover> cover_the_middles(const Recording& recording) {
  std::vector<Cover> covers;
  for (const auto& clip : recording.clips) {
    const double middle_s = 0.5 * (clip.start_s + clip.end_s);
    covers.push_back({middle_s - 0.5 * covered_s, middle_s + 0.5 * covered_s});
  }
  return covers;
}

struct RawError {
  double distance_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not found, or not known
  bool in_picture = false;
};

std::vector<RawError> object_errors(const Labels& labels, const Truth& truth) {
  std::vector<RawError> errors(labels.raw.time_s.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const auto place = find_place(truth, labels.raw.clip[i], labels.raw.time_s[i]);
    if (!place) continue;
    const Eigen::Vector3d position = interpolate(truth.object.position_m, *place);
    errors[i] = {(Eigen::Map<const Eigen::Vector3d>(&labels.raw.object_m[3 * i]) - position).norm(),
                 in_picture(truth, position)};
  }
  return errors;
}

}  // namespace

LabelError error_of_exact_positions(const Recording& recording, const Truth& truth) {
  const auto timeline = label::align(recording);
  const auto tracks = exact_tracks(recording, timeline, truth);
  const Eigen::Vector3d gravity(recording.camera.gravity.data());
  const bool bounces = label::falling_part(tracks, gravity) > label::falling_part_of_bounces;
  Labels labels;
  labels.clips = recording.clips;
  label::resample(label::glove_frames(recording, timeline), tracks,
                  label::smooth_bodies(tracks, gravity, bounces), 1.0 / recording.camera.rate_hz,
                  label::CalibrationError({}), labels);
  return compare_labels_with_truth(labels, truth);
}

double frames_to_recover(const RenderedRecording& rendered, const std::string& tracker) {
  const auto covers = cover_the_middles(rendered.recording());
  const auto labels = rendered.label(tracker, covers);
  const auto errors = object_errors(labels, rendered.truth());
  double most = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t clip = 0; clip < covers.size(); ++clip) {
    if (rendered.recording().clips[clip].dropped) continue;
    int frames = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (labels.raw.clip[i] != static_cast<std::int32_t>(clip)) continue;
      if (labels.raw.time_s[i] < covers[clip].to_s || !errors[i].in_picture) continue;
      if (++frames; errors[i].distance_m < found_m) break;
    }
    if (frames > 0) most = std::fmax(most, frames);
  }
  return most;
}

scene::ObjectSpec like_the_glove(scene::ObjectSpec object) {
  for (auto& solid : object.solids) solid.color = scene::glove_color();
  return object;
}

}  // namespace touchtrace::study
