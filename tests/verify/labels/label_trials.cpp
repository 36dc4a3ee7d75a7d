#include "tests/verify/labels/label_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/base/statistics.h"
#include "pipeline/label/states/states.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/scene/camera/visible.h"
#include "pipeline/study/truth_samples.h"

namespace touchtrace::study {
namespace {

constexpr double exact_m = 1e-5, covered_s = 1.0, found_m = 0.060;

label::Observation exact_observation(const Truth::Body& body, const TruthInterval& place) {
  label::Observation observation;
  observation.found = true;
  observation.position_m = interpolate(body.position_m, place);
  observation.sigma_m.setConstant(exact_m);
  return observation;
}

label::Observation with_noise(label::Observation observation, const Eigen::Vector3d& sigma_m,
                              RandomStream& random) {
  observation.sigma_m = sigma_m.cwiseMax(exact_m);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    observation.position_m[axis] += sigma_m[axis] * random.normal();
  return observation;
}

label::ClipTrack exact_track(const label::ClipFrames& frames, std::int32_t clip,
                             const std::vector<double>& camera_time_s, const Truth& truth) {
  label::ClipTrack track;
  for (std::size_t i = frames.first; i < frames.first + frames.count; ++i) {
    const auto place = find_interval(truth, clip, camera_time_s[i]);
    if (!place) continue;
    track.time_s.push_back(camera_time_s[i]);
    track.hand.push_back(exact_observation(truth.hand, *place));
    track.object.push_back(exact_observation(truth.object, *place));
  }
  return track;
}

std::vector<label::ClipTrack> exact_tracks(const Recording& recording,
                                           const label::Timeline& timeline, const Truth& truth) {
  std::vector<label::ClipTrack> tracks;
  const auto clips = label::clip_frames(recording);
  for (std::size_t i = 0; i < clips.size(); ++i)
    tracks.push_back(
        recording.clips[i].object_fell
            ? label::ClipTrack{}
            : exact_track(clips[i], static_cast<std::int32_t>(i), timeline.camera_time_s, truth));
  return tracks;
}

std::vector<Cover> cover_middles(const Recording& recording) {
  std::vector<Cover> covers;
  for (const auto& clip : recording.clips) {
    const double middle_s = 0.5 * (clip.start_s + clip.end_s);
    covers.push_back({middle_s - 0.5 * covered_s, middle_s + 0.5 * covered_s});
  }
  return covers;
}

LabelError error_of_tracks(const std::vector<label::ClipTrack>& tracks, const Recording& recording,
                           const label::Timeline& timeline, const Truth& truth) {
  const Eigen::Vector3d gravity =
      recording.camera.gravity_m_per_s2.value_or(Eigen::Vector3d(0.0, 9.81, 0.0));
  Labels labels;
  labels.clips = recording.clips;
  label::resample(label::label_times(recording, timeline), tracks,
                  label::smooth_bodies(tracks, gravity, label::Flights::find),
                  label::ErrorModel({}, 0.0), labels);
  return compare_labels_with_truth(labels, truth);
}

/// [frames] Errors of the object's raw positions against the truth `delay_s` earlier. NaN: not
/// found or no truth.
std::vector<Eigen::Vector3d> raw_errors_m(const Labels& labels, const Truth& truth,
                                          double delay_s) {
  std::vector<Eigen::Vector3d> errors_m(
      labels.raw.time_s.size(),
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t i = 0; i < errors_m.size(); ++i)
    if (const auto place = find_interval(truth, labels.raw.clip[i], labels.raw.time_s[i] - delay_s))
      errors_m[i] = row(labels.raw.object_m, i) - interpolate(truth.object.position_m, *place);
  return errors_m;
}

/// Whether the object is in a frame's image.
bool shows_object(const Truth& truth, const RawTrack& raw, std::size_t frame) {
  const auto place = find_interval(truth, raw.clip[frame], raw.time_s[frame]);
  return place && in_image(truth, interpolate(truth.object.position_m, *place));
}

/// Standard deviations of the white part of errors, from the median second difference over
/// neighbouring frames: that of white errors has six times their variance, that of slowly varying
/// errors nearly none.
Eigen::Vector3d white_sigma_m(const RawTrack& raw, const std::vector<Eigen::Vector3d>& errors_m) {
  Eigen::Vector3d sigma_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> differences_m;
    for (std::size_t i = 2; i < errors_m.size(); ++i) {
      const Eigen::Vector3d difference = errors_m[i] - 2.0 * errors_m[i - 1] + errors_m[i - 2];
      if (raw.clip[i] == raw.clip[i - 2] && difference.allFinite())
        differences_m.push_back(difference[axis]);
    }
    sigma_m[axis] = robust_sigma(std::move(differences_m)) / std::sqrt(6.0);
  }
  return sigma_m;
}

}  // namespace

LabelError error_of_exact_positions(const Recording& recording, const Truth& truth) {
  const auto timeline = label::align(recording);
  return error_of_tracks(exact_tracks(recording, timeline, truth), recording, timeline, truth);
}

LabelError error_of_white_positions(const Recording& recording, const Truth& truth,
                                    const Labels& labels) {
  // a delay left in would appear as errors of velocity
  const double delay_s = compare_labels_with_truth(labels, truth).object.delay_s;
  const auto errors_m = raw_errors_m(labels, truth, delay_s);
  const Eigen::Vector3d sigma_m = white_sigma_m(labels.raw, errors_m);
  RandomStream random(0, "white errors of positions");
  std::vector<label::ClipTrack> tracks(recording.clips.size());
  for (std::size_t i = 0; i < errors_m.size(); ++i) {
    const double time_s = labels.raw.time_s[i];
    const auto place = find_interval(truth, labels.raw.clip[i], time_s);
    if (!place || !errors_m[i].allFinite()) continue;
    auto& track = tracks[static_cast<std::size_t>(labels.raw.clip[i])];
    track.time_s.push_back(time_s);
    track.hand.push_back(exact_observation(truth.hand, *place));
    track.object.push_back(with_noise(exact_observation(truth.object, *place), sigma_m, random));
  }
  return error_of_tracks(tracks, recording, label::align(recording), truth);
}

double frames_to_recover(const RenderedRecording& rendered, const std::string& tracker) {
  const auto covers = cover_middles(rendered.recording());
  const auto labels = rendered.label(tracker, covers);
  const auto errors_m = raw_errors_m(labels, rendered.truth(), 0.0);
  double largest = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t clip = 0; clip < covers.size(); ++clip) {
    if (rendered.recording().clips[clip].object_fell) continue;
    int frames = 0;
    for (std::size_t i = 0; i < errors_m.size(); ++i) {
      if (labels.raw.clip[i] != static_cast<std::int32_t>(clip)) continue;
      if (labels.raw.time_s[i] < covers[clip].to_s ||
          !shows_object(rendered.truth(), labels.raw, i))
        continue;
      if (++frames; errors_m[i].norm() < found_m) break;
    }
    if (frames > 0) largest = std::fmax(largest, frames);
  }
  return largest;
}

scene::ObjectSpec with_glove_color(scene::ObjectSpec object) {
  for (auto& solid : object.solids) solid.color = scene::glove_color();
  return object;
}

}  // namespace touchtrace::study
