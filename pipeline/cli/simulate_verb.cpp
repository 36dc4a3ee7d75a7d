#include <fmt/core.h>

#include <filesystem>
#include <optional>

#include "engine/base/text.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/cli/verbs.h"
#include "pipeline/scene/object_file.h"
#include "pipeline/scene/simulate.h"

namespace touchtrace::cli {
namespace {

struct SimulateOptions {
  scene::SceneOptions scene;
  std::string output, object = "ball";
  bool no_images = false;
};

void describe(OptionSet& set, SimulateOptions& o) {
  scene::SceneOptions& s = o.scene;
  set.input("output", o.output, "the recording to write, an HDF5 file");
  set.choice("activity", s.activity, "what the hand does", scene::activity_names());
  set.text("object", o.object, "what it holds: a name (see `touchtrace objects`) or a TOML file");
  set.number("minutes", s.minutes, "recorded time, rounded to whole clips, at least one [min]",
             0.01, 1e4);
  set.number("clip-s", s.clip_s, "length of a clip; each has a new grasp [s]", 1.0, 600.0);
  set.number("pause-s", s.pause_s, "unrecorded time between clips [s]", 0.0, 600.0);
  set.integer("width", s.image_width, "of colour and depth images, a multiple of 16 [px]", 160,
              1280);
  set.integer("height", s.image_height, "of colour and depth images [px]", 120, 960);
  set.integer("board-views", s.board_views, "chessboard views for the calibration", 0, 200);
  set.flag("no-images", o.no_images, "glove and truth only, nothing is rendered");
  set.seed("seed", s.seed, "of every random number");
}

nlohmann::json to_json(const scene::SimulationSummary& summary, const std::string& output) {
  return {{"output", output},
          {"bytes", std::filesystem::file_size(output)},
          {"clips", summary.clips},
          {"dropped_clips", summary.dropped_clips},
          {"glove_frames", summary.glove_frames},
          {"camera_frames", summary.camera_frames},
          {"board_views", summary.board_views},
          {"wall_seconds", summary.wall_seconds},
          {"cpu_seconds", summary.cpu_seconds}};
}

ExitCode run(const SimulateOptions& options, const Invocation& invocation) {
  scene::SceneOptions scene = options.scene;
  scene.object = scene::object_of(options.object);
  Provenance provenance = start_provenance("touchtrace/recording/1", "simulate");
  provenance.options = invocation.options;
  provenance.seed = options.scene.seed;
  std::optional<Runtime> runtime;
  if (!options.no_images) {
    runtime.emplace(usable_device(invocation.device));
    provenance.device = runtime->device().name;
  }
  const auto summary =
      scene::simulate_recording(scene, runtime ? &*runtime : nullptr, options.output,
                                invocation.overwrite, std::move(provenance));
  if (invocation.json)
    fmt::print("{}\n", to_json(summary, options.output).dump(2));
  else
    fmt::print(
        "{}: {} clips ({} dropped the object), {} glove frames, {} camera frames, {} board views\n",
        options.output, summary.clips, summary.dropped_clips, summary.glove_frames,
        summary.camera_frames, summary.board_views);
  return ExitCode::done;
}

}  // namespace

Verb simulate_verb() {
  return make_verb<SimulateOptions>(
      "simulate", "simulate somebody with a tactile glove before an RGBD camera",
      {"touchtrace simulate wave.h5 --activity wave --object ball --minutes 2",
       "touchtrace simulate throw.h5 --activity throw --width 640 --height 480 --seed 7",
       "touchtrace simulate touch.h5 --minutes 10 --no-images"},
      run);
}

}  // namespace touchtrace::cli
