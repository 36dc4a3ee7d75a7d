#include "pipeline/study/verify_labels.h"

#include <filesystem>

#include "calib/rgbd/calibrate.h"
#include "calib/smooth/smoothing_figures.h"
#include "engine/base/scratch_folder.h"
#include "engine/cl/runtime.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/label/label.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/simulate.h"
#include "pipeline/study/label_error.h"

namespace touchtrace::study {
namespace {

namespace fs = std::filesystem;
using Emit = std::function<void(Figure)>;

void emit_object(const std::string& name, const BodyError& error, const Emit& emit) {
  emit(at_most(name + ": object lost or wrong",
               100.0 * (error.lost_share + error.wrong_unsaid_share), "%", 1.5));
  emit(at_most(name + ": object wrong, said to be right", 100.0 * error.wrong_unsaid_share, "%",
               0.5));
  const char* axes[] = {"x", "y", "depth"};
  const double goals_mm[] = {5.0, 5.0, 8.0};
  for (int axis = 0; axis < 3; ++axis)
    emit(at_most(name + ": object position RMS, " + axes[axis], 1e3 * error.position_spread_m[axis],
                 "mm", goals_mm[axis]));
  emit(reported(name + ": object bias", 1e3 * error.bias_m.norm(), "mm"));
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

void measure_tracker(const std::string& activity, const std::string& tracker,
                     const fs::path& recording, const RgbdCalibration& calibration,
                     const Emit& emit) {
  label::LabelOptions options;
  options.tracker = tracker;
  const RecordingReader reader(recording);
  const auto labels = label::label_recording(reader, calibration, options);
  const auto error = compare_labels_with_truth(labels, read_truth(recording));
  const auto name = activity + ", " + tracker;
  emit_object(name, error.object, emit);
  emit_hand(name, error.hand, emit);
  const double frames = static_cast<double>(reader.recording().camera_times.frames());
  emit(at_most(name + ": processor time of both targets",
               1e3 * labels.summary["seconds"]["follow_cpu"].get<double>() / frames, "ms/frame",
               20.0));
}

void measure_chain(const std::string& activity, const Emit& emit) {
  const ScratchFolder folder;
  const auto recording = folder.path() / (activity + ".h5");
  Runtime runtime(choose_device({}));
  scene::SceneOptions options;
  options.activity = activity;
  options.object = scene::default_object(activity);
  options.minutes = 0.5;
  scene::simulate_recording(options, &runtime, recording, true,
                            start_provenance("touchtrace/recording/1", "verify"));
  const auto calibration = calibrate(board_views_of_recording(recording));
  for (const char* tracker : {"csrt", "component"})
    measure_tracker(activity, tracker, recording, calibration, emit);
}

}  // namespace

Verification verify_labels() {
  return [](const Emit& emit) {
    measure_smoothing(emit);
    for (const char* activity : {"wave", "throw", "pingpong"}) measure_chain(activity, emit);
  };
}

}  // namespace touchtrace::study
