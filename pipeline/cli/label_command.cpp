#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/label/label.h"
#include "pipeline/recording/tum_trajectory.h"

namespace touchtrace::cli {
namespace {

struct LabelCommandOptions {
  std::string recording, calibration, output, trajectories;
  label::LabelOptions label;
};

void describe(OptionSet& set, LabelCommandOptions& o) {
  set.input("recording", o.recording, "the recording to label");
  set.path(
      "calibration", o.calibration,
      "folder that `calibrate` wrote, or a camera_info, cv::FileStorage or camchain YAML file");
  set.path("output", o.output, "labels to write, e.g. labels.h5");
  set.text("trajectories", o.trajectories,
           "folder for hand.txt and object.txt, TUM trajectories as evo reads them");
  label::describe(set, o.label);
}

void print_summary(const Labels& labels, const std::string& output) {
  const auto& s = labels.summary;
  fmt::print("{} labels of {} clips in {}\n", labels.time_s.size(), labels.clips.size(), output);
  fmt::print("lost: hand {:.2f} %, object {:.2f} %; object only follows the hand in {:.2f} %\n",
             100.0 * s["hand_lost_share"].get<double>(),
             100.0 * s["object_lost_share"].get<double>(),
             100.0 * s["object_follows_share"].get<double>());
  fmt::print("clocks: camera drift {:.1f} ppm, glove drift {:.1f} ppm; flights: {}\n",
             s["clocks"]["camera"]["drift_ppm"].get<double>(),
             s["clocks"]["glove"]["drift_ppm"].get<double>(), s["flights"].size());
}

/// Refuses early what may not be written.
void require_writable(const LabelCommandOptions& options, bool overwrite) {
  const OutputFile labels(options.output, overwrite);
  if (options.trajectories.empty()) return;
  for (const auto& path : tum_trajectory_files(options.trajectories))
    const OutputFile file(path, overwrite);
}

ExitCode run(const LabelCommandOptions& options, const Invocation& invocation) {
  const Stopwatch stopwatch;
  require_writable(options, invocation.overwrite);
  auto provenance = start_provenance("touchtrace/labels/1", "label");
  provenance.options = invocation.options;
  provenance.add_input(options.recording);
  const RecordingReader reader(options.recording);
  auto labels =
      label::label_recording(reader, read_calibration(options.calibration), options.label);
  stopwatch.stop(provenance);
  labels.provenance = std::move(provenance);
  write_labels(options.output, labels, invocation.overwrite);
  if (!options.trajectories.empty())
    write_tum_trajectories(options.trajectories, labels, reader.recording().epoch_unix_s,
                           invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", labels.summary.dump(2));
  else
    print_summary(labels, options.output);
  return ExitCode::done;
}

}  // namespace

Command label_command() {
  return make_command<LabelCommandOptions>(
      "label", "follow hand and object in a recording and write their states at every glove frame",
      {"touchtrace label wave.h5 --calibration camera --output labels.h5",
       "touchtrace label wave.h5 --calibration camera --output labels.h5 --tracker component "
       "--json",
       "touchtrace label wave.h5 --calibration camera --output labels.h5 --trajectories tum"},
      run);
}

}  // namespace touchtrace::cli
