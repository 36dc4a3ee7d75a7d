#include "tests/verify/study/simulated_labels.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/dataset/load.h"
#include "pipeline/label/label.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/base/motion.h"
#include "pipeline/study/truth.h"
#include "pipeline/study/unlabelled.h"

namespace touchtrace::study {
namespace {

constexpr double difference_s = 1e-3;

struct ActivityErrorModel {
  const char* activity;
  LabelErrorModel error;
};

constexpr ActivityErrorModel measured_errors[] = {
    {"wave",
     {{{0.0008, 0.0006, 0.0013}, 0.0125, 0.136},
      {{0.0051, 0.0051, 0.0051}, 0.021, 0.131},
      0.018,
      0.002}},
    {"throw",
     {{{0.0006, 0.0006, 0.0008}, 0.0240, 0.171},
      {{0.0044, 0.0044, 0.0044}, 0.034, 0.171},
      0.018,
      0.025}},
    {"pingpong",
     {{{0.0002, 0.0006, 0.0002}, 0.0032, 0.454},
      {{0.0028, 0.0028, 0.0028}, 0.035, 0.098},
      0.018,
      0.003}},
    {"balance",
     {{{0.0007, 0.0005, 0.0007}, 0.0084, 0.030},
      {{0.0035, 0.0035, 0.0035}, 0.025, 0.047},
      0.018,
      0.003}},
};

void attach_truth_at_delay(Dataset& data, const std::vector<LabelledRecording>& sources,
                           double delay_s) {
  for (double& time_s : data.time_s) time_s -= delay_s;
  attach_truth(data, sources);
  for (double& time_s : data.time_s) time_s += delay_s;
}

/// Adds errors to one axis of one body in a clip.
void add_label_noise(Dataset& data, const Sequence& clip, const BodyErrorModel& model, int first,
                     int axis, RandomStream random) {
  const double sigma_m = model.position_m[static_cast<std::size_t>(axis)];
  const double band_hz = std::sqrt(3.0) * model.velocity_m_per_s / (2 * std::numbers::pi * sigma_m);
  const scene::SmoothNoise noise(random, band_hz);
  const double white = std::sqrt(std::max(
      0.0, std::pow(model.causal_velocity_m_per_s, 2) - std::pow(model.velocity_m_per_s, 2)));
  for (int frame = clip.first_frame; frame < clip.first_frame + clip.frames; ++frame) {
    const double t = data.time_s[frame];
    const double speed =
        (noise.at(t + difference_s) - noise.at(t - difference_s)) / (2 * difference_s) * sigma_m;
    State &label = data.label[frame], &causal = data.causal_label[frame];
    label[first + axis] += static_cast<float>(sigma_m * noise.at(t));
    label[first + 3 + axis] += static_cast<float>(speed);
    causal[first + axis] = label[first + axis];
    causal[first + 3 + axis] =
        label[first + 3 + axis] + static_cast<float>(white * random.normal());
  }
}

void add_label_noise(Dataset& data, const LabelErrorModel& model, std::uint64_t seed) {
  RandomStream lost(seed, "modelled labels lost");
  for (std::uint8_t& trusted : data.trusted) trusted = lost.uniform() >= model.lost_share;
  for (const Sequence& clip : data.sequences)
    for (int axis = 0; axis < 3; ++axis) {
      const auto stream = [&](const char* body) {
        return RandomStream(seed, fmt::format("modelled labels {} {} {}", body, clip.clip, axis));
      };
      add_label_noise(data, clip, model.object, 0, axis, stream("object"));
      add_label_noise(data, clip, model.hand, 6, axis, stream("hand"));
    }
}

}  // namespace

const LabelErrorModel& measured_label_error(const std::string& activity) {
  const auto row = std::ranges::find(measured_errors, activity, &ActivityErrorModel::activity);
  if (row == std::end(measured_errors))
    throw usage_error(fmt::format("no measured label errors for activity '{}'", activity),
                      "use --images: labels of rendered images");
  return row->error;
}

Dataset load_with_modelled_labels(const std::filesystem::path& recording,
                                  const LabelErrorModel& model, int resolution,
                                  std::uint64_t seed) {
  const std::vector<LabelledRecording> sources{{recording, {}}};
  Dataset data =
      load_dataset(recording, unlabelled(RecordingReader(recording).recording()), resolution);
  attach_truth_at_delay(data, sources, model.delay_s);
  data.label = data.causal_label = data.truth;
  add_label_noise(data, model, seed);
  attach_truth(data, sources);
  shift_truth(data, estimate_truth_offset(data));
  return data;
}

Dataset load_with_rendered_labels(const std::filesystem::path& recording, int resolution) {
  const ScratchFolder folder;
  const std::vector<LabelledRecording> sources{{recording, folder.path() / "labels.h5"}};
  label::LabelOptions options;
  options.tracker = "component";
  write_labels(sources[0].labels,
               label::label_recording(RecordingReader(recording),
                                      calibrate(board_views_from_recording(recording)), options),
               false);
  Dataset data = load_dataset(sources, resolution);
  attach_truth(data, sources);
  shift_truth(data, estimate_truth_offset(data));
  return data;
}

}  // namespace touchtrace::study
