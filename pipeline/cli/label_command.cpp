#include <fmt/core.h>

#include <array>
#include <future>

#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/intrinsics.h"
#include "pipeline/cli/commands.h"
#include "pipeline/label/camera_calibration.h"
#include "pipeline/label/label.h"
#include "pipeline/label/preview/preview.h"

namespace touchtrace::cli {
namespace {

struct LabelCommandOptions {
  std::string recording, calibration, output, preview;
  label::LabelOptions label;
};

void describe(OptionSet& set, LabelCommandOptions& o) {
  set.input("recording", o.recording, "HDF5 with RGB-D images and boxes or masks");
  set.text("calibration", o.calibration,
           "folder from `calibrate`, or what `import --camera-info` reads: camera_info, OpenCV or "
           "kalibr YAML, a 3x3 matrix; default: the camera's intrinsics in the recording")
      .value("PATH");
  set.path("output", o.output, "labels (.h5)").value("FILE");
  set.text("preview", o.preview, "also write a video of the labels on the images, .mp4 or .avi")
      .value("VIDEO");
  label::describe(set, o.label);
}

/// Shape of an object in `summary`, with its full extents.
std::string describe_shape(const nlohmann::json& shape) {
  if (shape.contains("radius_m"))
    return fmt::format("sphere of {:.0f} mm", 2e3 * shape["radius_m"].get<double>());
  const auto half_m = shape["half_extents_m"].get<std::array<double, 3>>();
  return fmt::format("{} of {:.0f} x {:.0f} x {:.0f} mm", shape["core"].get<std::string>(),
                     2e3 * half_m[0], 2e3 * half_m[1], 2e3 * half_m[2]);
}

void print_summary(const Labels& labels, const std::string& output) {
  const auto& s = labels.summary;
  fmt::print("{} labels of {} clips in {}\n", labels.time_s.size(), labels.clips.size(), output);
  fmt::print("lost: hand {:.2f} %, object {:.2f} %; object moved with the hand in {:.2f} %\n",
             100.0 * s["hand_lost_share"].get<double>(),
             100.0 * s["object_lost_share"].get<double>(),
             100.0 * s["object_follows_share"].get<double>());
  const auto millimetres = [](const nlohmann::json& m) {
    return m.is_null() ? std::string("-") : fmt::format("{:.1f} mm", 1e3 * m.get<double>());
  };
  fmt::print("standard deviation of a position (median): hand {}, object {}\n",
             millimetres(s["hand_sigma_m"]), millimetres(s["object_sigma_m"]));
  for (const auto& [object, shape] : s["object_shape"].items())
    fmt::print("shape of {}: {}\n", object, describe_shape(shape));
  fmt::print("flights: {}\n", s["flights"].size());
}

void warn_of_problems(const Labels& labels) {
  for (const auto& problem : labels.summary["problems"])
    Progress::warn(fmt::format("clip {} not labelled: {}", problem["clip"].get<int>(),
                               problem["problem"].get<std::string>()));
}

/// Fails before the work if an output exists.
void require_writable(const LabelCommandOptions& options, bool overwrite) {
  const OutputFile labels(options.output, overwrite);
  if (!options.preview.empty()) label::require_preview_path(options.preview, overwrite);
}

ExitCode run(const LabelCommandOptions& options, const Invocation& invocation) {
  const Stopwatch stopwatch;
  require_writable(options, invocation.overwrite);
  auto provenance = start_provenance("touchtrace/labels/1", "label");
  provenance.options = invocation.options;
  auto hash =
      std::async(std::launch::async, sha256_of_file, std::filesystem::path(options.recording));
  const RecordingReader reader(options.recording);
  std::optional<RgbdCalibration> calibration;
  const CameraInfo& camera = reader.recording().camera;
  if (!options.calibration.empty())
    calibration = read_intrinsics(options.calibration, camera.width, camera.height);
  const auto write_preview = [&](const Labels& labels) {
    if (!options.preview.empty())
      label::write_preview(options.preview, reader.recording(), label::frame_source(reader),
                           label::camera_calibration(calibration, camera), labels,
                           invocation.overwrite);
  };
  const auto show_refused = [&](const Labels& measured) {
    write_preview(measured);
    if (!options.preview.empty())
      Progress::warn(
          fmt::format("{} shows what was found in a recording that cannot be "
                      "labelled: centres before smoothing",
                      options.preview));
  };
  auto labels = label::label_recording(reader, calibration, options.label, show_refused);
  warn_of_problems(labels);
  provenance.inputs.push_back({options.recording, hash.get()});
  stopwatch.stop(provenance);
  labels.provenance = std::move(provenance);
  write_labels(options.output, labels, invocation.overwrite);
  write_preview(labels);
  if (invocation.json)
    fmt::print("{}\n", labels.summary.dump(2));
  else
    print_summary(labels, options.output);
  return ExitCode::done;
}

}  // namespace

Command label_command() {
  return make_command<LabelCommandOptions>(
      "label", "label hand and object states, with covariance, at every glove or camera frame",
      {"touchtrace label wave.h5 --calibration camera --output labels.h5",
       "touchtrace label wave.h5 --calibration camera --output labels.h5 --tracker component "
       "--json",
       "touchtrace label wave.h5 --calibration camera --output labels.h5 --preview wave.mp4"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
