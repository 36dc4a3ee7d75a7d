#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace::testing {

/// Temporary folder, removed by the destructor.
class TemporaryFolder : public ScratchFolder {
 public:
  std::filesystem::path operator/(const std::string& name) const { return path() / name; }
};

/// Writes a file without the safety of OutputFile.
inline void put(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Contents of a recording file, which tests modify before writing.
struct SampleRecording {
  Recording recording;
  std::vector<RgbdFrame> frames, background, board;
  Truth truth;
};

inline constexpr double sample_rate_hz = 15.0, sample_truth_rate_hz = 100.0;

inline RgbdFrame sample_image(const CameraInfo& camera, RandomStream& random) {
  const auto pixels = static_cast<std::size_t>(camera.width * camera.height);
  RgbdFrame frame{std::vector<std::uint8_t>(3 * pixels), std::vector<std::uint16_t>(pixels)};
  for (auto& value : frame.color) value = static_cast<std::uint8_t>(random.below(256));
  for (auto& value : frame.depth) value = static_cast<std::uint16_t>(random.below(5000));
  return frame;
}

/// Stream of 6 x 5 taxels, one of them missing; of every 20 frames, frame 7 is lost.
inline GloveStream sample_glove(int frames, double start_s, RandomStream& random) {
  GloveStream glove;
  glove.info.rows = 6, glove.info.cols = 5;
  glove.info.scan_s = 0.05;
  glove.info.baseline_counts.assign(30, 20.5f);
  glove.info.mask.assign(30, 1);
  glove.info.mask[4] = 0;
  glove.info.taxel_position_m.assign(90, std::nanf(""));
  for (int i = 0; i < frames; ++i) {
    if (i % 20 == 7) continue;
    glove.sequence.push_back(1000u + static_cast<unsigned>(i));
    glove.host_time_s.push_back(start_s + i / sample_rate_hz + 1e-3 * random.uniform());
    for (int taxel = 0; taxel < glove.info.taxels(); ++taxel)
      glove.counts.push_back(static_cast<std::uint16_t>(20 + random.below(600)));
  }
  return glove;
}

inline Truth::Body sample_body(const std::vector<double>& time_s, double phase) {
  Truth::Body body;
  for (double t : time_s) {
    for (double rate : {1.0, 2.0, 3.0}) {
      body.position_m.push_back(0.1 * std::sin(rate * t + phase));
      body.velocity_m_per_s.push_back(0.1 * rate * std::cos(rate * t + phase));
    }
    for (double q : {1.0, 0.0, 0.0, 0.0}) body.orientation_wxyz.push_back(q);
  }
  return body;
}

inline Truth sample_truth(const std::vector<Clip>& clips) {
  Truth truth;
  for (std::size_t clip = 0; clip < clips.size(); ++clip)
    for (double t = clips[clip].start_s; t < clips[clip].end_s; t += 1.0 / sample_truth_rate_hz) {
      truth.time_s.push_back(t);
      truth.clip.push_back(static_cast<std::int32_t>(clip));
    }
  truth.hand = sample_body(truth.time_s, 0.5);
  truth.object = sample_body(truth.time_s, 0.0);
  truth.contact_force_n.assign(3 * truth.time_s.size(), 0.25);
  truth.events = {{clips[0].start_s + 0.5, "release"}, {clips[0].start_s + 0.75, "catch"}};
  truth.calibration = {{"fx", 300.5}};
  truth.clocks = {{"glove_offset_s", 0.0125}};
  return truth;
}

/// Two clips of `frames_per_clip` glove frames (lost ones included), images of 8 x 6 pixels at 20
/// Hz, truth at 100 Hz.
inline SampleRecording sample_recording(int frames_per_clip = 20) {
  SampleRecording sample;
  Recording& recording = sample.recording;
  RandomStream random(1, "sample recording");
  const double clip_s = frames_per_clip / sample_rate_hz, pause_s = 2.0;
  recording.activity = "wave";
  recording.epoch_unix_s = 1.7e9;
  for (int i = 0; i < 2; ++i) {
    const double start_s = 10.0 + i * (clip_s + pause_s);
    recording.clips.push_back(
        {start_s, start_s + clip_s, i == 0 ? "ball" : "box", false, {1, 2, 3, 4}, {4, 1, 3, 3}});
    const auto stream = sample_glove(frames_per_clip, start_s, random);
    if (i == 0) {
      recording.gloves = {stream};
      continue;
    }
    auto& glove = recording.gloves[0];
    for (auto sequence : stream.sequence) glove.sequence.push_back(sequence + 10000);
    glove.host_time_s.insert(glove.host_time_s.end(), stream.host_time_s.begin(),
                             stream.host_time_s.end());
    glove.counts.insert(glove.counts.end(), stream.counts.begin(), stream.counts.end());
  }
  recording.camera.width = 8, recording.camera.height = 6;
  recording.camera.depth_camera = Camera{8, 6, 7.5, 7.25, 4.0, 3.0};
  recording.camera.gravity_m_per_s2 = {0.0, 9.81, 0.0};
  recording.provenance = start_provenance("touchtrace/recording/2", "simulate");
  recording.provenance.options = {{"activity", "wave"}};
  for (const auto& clip : recording.clips)
    for (double t = clip.start_s; t < clip.end_s; t += 1.0 / recording.camera.rate_hz) {
      recording.camera_times.sequence.push_back(sample.frames.size());
      recording.camera_times.device_time_s.push_back(t - 3.0);
      recording.camera_times.host_time_s.push_back(t);
      sample.frames.push_back(sample_image(recording.camera, random));
    }
  sample.frames[2].mask.resize(48);
  for (auto& value : sample.frames[2].mask) value = static_cast<std::uint8_t>(random.below(3));
  sample.background = {sample_image(recording.camera, random)};
  sample.board = {sample_image(recording.camera, random), sample_image(recording.camera, random)};
  sample.truth = sample_truth(recording.clips);
  return sample;
}

inline void write(const SampleRecording& sample, const std::filesystem::path& path,
                  bool with_truth = true, bool overwrite = false) {
  RecordingWriter writer(path, sample.recording.camera, overwrite);
  for (const auto& frame : sample.frames) writer.append_camera_frame(frame);
  for (const auto& frame : sample.background) writer.append_background(frame);
  for (const auto& frame : sample.board) writer.append_board_view(frame);
  if (with_truth) writer.write_truth(sample.truth);
  writer.finish(sample.recording);
}

inline LabelledBody sample_labelled_body(std::size_t labels, RandomStream& random) {
  LabelledBody body;
  const auto numbers = [&](std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values) value = random.normal();
    return values;
  };
  body.position_m = numbers(3 * labels);
  body.velocity_m_per_s = numbers(3 * labels);
  body.covariance = numbers(36 * labels);
  body.causal_position_m = numbers(3 * labels);
  body.causal_velocity_m_per_s = numbers(3 * labels);
  body.quality.assign(labels, quality_good);
  body.error_budget_m = numbers(5 * labels);
  return body;
}

/// One label per frame of glove 0, lost ones included; all numbers differ.
inline Labels sample_labels(const Recording& recording) {
  Labels labels;
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  const auto& glove = recording.gloves[0];
  std::size_t frame = 0;
  for (std::size_t clip = 0; clip < recording.clips.size(); ++clip)
    for (double t = recording.clips[clip].start_s; t < recording.clips[clip].end_s - 1e-6;
         t += 1 / sample_rate_hz) {
      const bool present =
          frame < glove.frames() && std::abs(glove.host_time_s[frame] - t) < 0.5 / sample_rate_hz;
      labels.time_s.push_back(t);
      labels.clip.push_back(static_cast<std::int32_t>(clip));
      labels.glove_frame.push_back(present ? static_cast<std::int64_t>(frame++) : -1);
    }
  RandomStream random(2, "sample labels");
  labels.hand = sample_labelled_body(labels.time_s.size(), random);
  labels.object = sample_labelled_body(labels.time_s.size(), random);
  labels.raw.time_s = recording.camera_times.host_time_s;
  labels.raw.clip.assign(labels.raw.time_s.size(), 0);
  for (auto* column : {&labels.raw.hand_m, &labels.raw.object_m, &labels.raw.hand_sigma_m,
                       &labels.raw.object_sigma_m})
    column->assign(3 * labels.raw.time_s.size(), std::nan(""));
  labels.summary = {
      {"lost", 0},
      {"error_sources", {"smoothing", "correlated", "shape", "calibration", "latency"}}};
  labels.contact_sheet_jpeg = {0xff, 0xd8, 0xff, 0xd9};
  labels.provenance = start_provenance("touchtrace/labels/1", "label");
  return labels;
}

}  // namespace touchtrace::testing
