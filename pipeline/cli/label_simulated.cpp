#include "pipeline/cli/label_simulated.h"

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/study/sessions.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

/// Provenance of another output of the same command.
Provenance provenance_of(const char* schema, const Provenance& recording) {
  Provenance provenance = recording;
  provenance.schema = schema;
  return provenance;
}

RgbdCalibration calibrate_scene(const scene::RenderedScene& scene, const Provenance& recording) {
  const Stopwatch stopwatch;
  RgbdCalibration calibration = calibrate(
      detect_board_views(scene.recording().camera, scene.recording().board, scene.board_views(),
                         [&](std::size_t i) { return scene.board_view(i); }));
  if (calibration.details["verdict"] == "BAD")
    throw data_error("the camera cannot be calibrated from the simulated board views",
                     "give more --board-views or larger images");
  Provenance provenance = provenance_of(calibration_schema, recording);
  stopwatch.stop(provenance);
  calibration.details["provenance"] = provenance;
  return calibration;
}

label::FrameSource frame_source(const scene::RenderedScene& scene) {
  return {[&scene](std::size_t i) { return scene.camera_frame(i); },
          [&scene](std::size_t i) { return scene.background(i); }, scene.background_frames()};
}

}  // namespace

scene::SimulationSummary simulate_labelled(const scene::SceneOptions& options, Runtime& runtime,
                                           const label::LabelOptions& labelling,
                                           const fs::path& recording, bool overwrite,
                                           const Provenance& provenance) {
  const Stopwatch stopwatch;
  const scene::RenderedScene scene(options, runtime);
  const RgbdCalibration calibration = calibrate_scene(scene, provenance);
  Labels labels =
      label::label_recording(scene.recording(), frame_source(scene), calibration, labelling);
  write_calibration(fs::path(recording).replace_extension(".calibration"), calibration, overwrite);
  auto summary = scene.write(recording, overwrite, provenance);
  summary.camera_frames = scene.recording().camera_times.frames();
  summary.board_views = scene.board_views();
  labels.provenance = provenance_of("touchtrace/labels/1", provenance);
  labels.provenance.add_input(recording);
  stopwatch.stop(labels.provenance);
  summary.wall_seconds = labels.provenance.wall_seconds;
  summary.cpu_seconds = labels.provenance.cpu_seconds;
  write_labels(labels_path_of(recording), labels, overwrite);
  return summary;
}

}  // namespace touchtrace::cli
