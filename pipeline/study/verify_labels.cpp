#include "pipeline/study/verify_labels.h"

#include <fmt/core.h>

#include <array>
#include <filesystem>

#include "calib/rgbd/calibrate.h"
#include "calib/smooth/smoothing_figures.h"
#include "engine/base/scratch_folder.h"
#include "engine/cl/runtime.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/label/label.h"
#include "pipeline/scene/objects/object.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/simulate.h"
#include "pipeline/study/label_error.h"

namespace touchtrace::study {
namespace {

namespace fs = std::filesystem;
using Emit = std::function<void(Figure)>;

/// The whole flight of a ball on a racket is before the camera, nothing hides it.
std::array<double, 3> goals_mm(const std::string& activity) {
  if (activity == "pingpong") return {2.0, 2.0, 2.0};
  return {5.0, 5.0, 8.0};
}

void emit_object(const std::string& name, const BodyError& error,
                 const std::array<double, 3>& most_mm, const Emit& emit) {
  emit(at_most(name + ": object lost or wrong",
               100.0 * (error.lost_share + error.wrong_unsaid_share), "%", 1.5));
  emit(reported(name + ": object outside the picture", 100.0 * error.outside_share, "%"));
  emit(at_most(name + ": object wrong, said to be right", 100.0 * error.wrong_unsaid_share, "%",
               0.5));
  const char* axes[] = {"x", "y", "depth"};
  for (int axis = 0; axis < 3; ++axis)
    emit(at_most(name + ": object position RMS about its bias, " + axes[axis],
                 1e3 * error.position_spread_m[axis], "mm", most_mm[axis]));
  emit(reported(name + ": object bias", 1e3 * error.bias_m.norm(), "mm"));
  emit(reported(name + ": labels next to an impact, not judged below", 100.0 * error.impact_share,
                "%"));
  emit(reported(name + ": object velocity RMS", error.aligned_velocity_rms_m_per_s, "m/s"));
  emit(
      reported(name + ": object velocity RMS, latency left in", error.velocity_rms_m_per_s, "m/s"));
  emit(reported(name + ": object velocity RMS, filtered, latency left in",
                error.causal_velocity_rms_m_per_s, "m/s"));
  emit(reported(name + ": delay that no stamp shows", 1e3 * error.delay_s, "ms"));
  emit(within(name + ": object positions in their 80 % interval", error.position_coverage, "", 0.78,
              0.82));
  emit(within(name + ": object velocities in their 80 % interval", error.velocity_coverage, "",
              0.78, 0.82));
  emit(within(name + ": object NEES", error.nees, "", 0.8, 1.2));
}

void emit_hand(const std::string& name, const BodyError& error, const Emit& emit) {
  emit(reported(name + ": hand blob from palm", 1e3 * error.bias_m.norm(), "mm"));
  emit(reported(name + ": hand position RMS about that", 1e3 * error.position_spread_m.norm(),
                "mm"));
  emit(reported(name + ": hand velocity RMS", error.aligned_velocity_rms_m_per_s, "m/s"));
  emit(reported(name + ": hand velocity RMS, latency left in", error.velocity_rms_m_per_s, "m/s"));
  emit(reported(name + ": hand velocity RMS, filtered, latency left in",
                error.causal_velocity_rms_m_per_s, "m/s"));
}

/// A recording to be rendered and labelled.
struct RenderedScene {
  std::string activity, object;
  std::uint64_t seed;
  std::vector<std::string> trackers;

  std::string name() const {
    return object == scene::default_object(activity).name
               ? activity
               : fmt::format("{} of {}", activity, object);
  }
};

/// Other objects and seeds are labelled without CSRT, whose time the first ones tell.
std::vector<RenderedScene> rendered_scenes() {
  const auto usual = [](const std::string& activity) {
    return scene::default_object(activity).name;
  };
  return {{"wave", usual("wave"), 1, {"csrt", "component"}},
          {"throw", usual("throw"), 1, {"csrt", "component"}},
          {"pingpong", usual("pingpong"), 1, {"csrt", "component"}},
          {"balance", usual("balance"), 2, {"component"}},
          {"wave", "box", 2, {"component"}},
          {"wave", "egg", 3, {"component"}},
          {"throw", "cube", 2, {"component"}},
          {"throw", "soap", 3, {"component"}}};
}

void measure_tracker(const RenderedScene& rendered, const std::string& tracker,
                     const fs::path& recording, const RgbdCalibration& calibration,
                     const Emit& emit) {
  label::LabelOptions options;
  options.tracker = tracker;
  const RecordingReader reader(recording);
  const auto labels = label::label_recording(reader, calibration, options);
  const auto error = compare_labels_with_truth(labels, read_truth(recording));
  const auto name = rendered.name() + ", " + tracker;
  emit_object(name, error.object, goals_mm(rendered.activity), emit);
  emit_hand(name, error.hand, emit);
  const double frames = static_cast<double>(reader.recording().camera_times.frames());
  emit(at_most(name + ": processor time of both targets",
               1e3 * labels.summary["seconds"]["follow_cpu"].get<double>() / frames, "ms/frame",
               20.0));
}

void measure_chain(const RenderedScene& rendered, const Emit& emit) {
  const ScratchFolder folder;
  const auto recording = folder.path() / (rendered.activity + ".h5");
  Runtime runtime(choose_device({}));
  scene::SceneOptions options;
  options.activity = rendered.activity;
  options.object = scene::find_object(rendered.object);
  options.seed = rendered.seed;
  options.minutes = 0.5;
  scene::simulate_recording(options, &runtime, recording, true,
                            start_provenance("touchtrace/recording/1", "verify"));
  const auto calibration = calibrate(board_views_of_recording(recording));
  for (const auto& tracker : rendered.trackers)
    measure_tracker(rendered, tracker, recording, calibration, emit);
}

}  // namespace

Verification verify_labels() {
  return [](const Emit& emit) {
    measure_smoothing(emit);
    for (const auto& rendered : rendered_scenes()) measure_chain(rendered, emit);
  };
}

}  // namespace touchtrace::study
