#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/data_sets.h"
#include "pipeline/scene/simulate/simulate.h"

namespace touchtrace::cli {
namespace {

struct SimulateOptions {
  scene::SceneOptions scene;
  std::string output, object, dataset;
  std::vector<std::string> assume;
  double share = 1.0;
  bool no_images = false, images = false, resume = false;

  bool rendered() const { return dataset.empty() ? !no_images : images; }
};

void describe(OptionSet& set, SimulateOptions& o) {
  scene::SceneOptions& s = o.scene;
  set.input("output", o.output,
            "the recording to write, an HDF5 file; of several objects: a folder");
  set.choice("activity", s.activity, "what the hand does", scene::activity_names());
  set.text(
      "object", o.object,
      "what it holds: names, roles (see `touchtrace objects`) or TOML files, with commas between; "
      "default: what suits the activity");
  set.number("minutes", s.minutes,
             "recorded time of each object, rounded to whole clips, at least one [min]", 0.01, 1e4);
  set.number("clip-s", s.clip_s, "mean length of a clip; each has a new grasp [s]", 1.0, 600.0);
  set.number("clip-spread", s.clip_spread, "clips are longer or shorter by this share at most", 0.0,
             0.9);
  set.number("pause-s", s.pause_s, "unrecorded time between clips, at least [s]", 0.0, 600.0);
  set.integer("width", s.image_width, "of colour and depth images, a multiple of 16 [px]", 160,
              1280);
  set.integer("height", s.image_height, "of colour and depth images [px]", 120, 960);
  set.integer("board-views", s.board_views, "chessboard views for the calibration", 0, 200);
  set.integer("glove", s.glove, "which specimen: each has gains, dead taxels and drift of its own",
              1, 1000);
  set.flag(
      "imu", s.inertial_unit,
      "an inertial unit on the back of the hand: specific force, angular velocity, orientation");
  set.texts("assume", o.assume,
            "NAME=VALUE: what the scene assumes instead (see `touchtrace assumptions`)");
  set.text(
      "dataset", o.dataset,
      "'paper': a folder of recordings with activities, objects and frames as in its table, not "
      "rendered");
  set.number("share", o.share, "of a data set's frames", 1e-4, 1.0);
  set.flag("images", o.images, "render a data set, too");
  set.flag("no-images", o.no_images, "glove and truth only, nothing is rendered");
  set.flag("resume", o.resume, "keep the recordings in the folder that these options made");
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

/// One object, and the recording that is made of it.
struct Part {
  scene::SceneOptions scene;
  std::filesystem::path output;
  Provenance provenance;
};

/// The objects of one name or file, or those of a role that the activity takes.
std::vector<scene::ObjectSpec> objects_of(const std::string& name, const std::string& activity) {
  const scene::ActivityRow& row = scene::find_activity(activity);
  std::vector<scene::ObjectSpec> meant, fitting;
  for (const scene::ObjectSpec& object : scene::objects())
    if (scene::role_name(object.role) == name) meant.push_back(object);
  if (meant.empty()) meant.push_back(scene::object_of(name));
  std::ranges::copy_if(meant, std::back_inserter(fitting), row.takes);
  if (fitting.empty()) scene::require_fit(row, meant.front());
  return fitting;
}

std::vector<std::string> object_names(const SimulateOptions& options) {
  if (options.object.empty()) return {scene::default_object(options.scene.activity).name};
  return split_text(options.object, ',');
}

Provenance provenance_of(const scene::SceneOptions& scene, const Invocation& invocation,
                         const std::string& device) {
  Provenance provenance = start_provenance("touchtrace/recording/1", "simulate");
  provenance.options = invocation.options;
  provenance.options["activity"] = scene.activity;
  provenance.options["object"] = scene.object.name;
  provenance.options["minutes"] = scene.minutes;
  provenance.options["seed"] = scene.seed;
  provenance.options["assume"] = scene::parameters_json(scene.parameters);
  provenance.seed = scene.seed;
  provenance.device = device;
  return provenance;
}

std::vector<Part> parts_of_data_set(const SimulateOptions& options, const Invocation& invocation,
                                    const std::string& device) {
  if (!options.object.empty())
    throw usage_error("a data set has objects of its own", "leave out --object or --dataset");
  std::vector<Part> parts;
  for (auto& planned :
       recordings_of(scene::find_data_set(options.dataset), options.scene, options.share)) {
    Provenance provenance = provenance_of(planned.scene, invocation, device);
    parts.push_back({std::move(planned.scene), std::filesystem::path(options.output) / planned.file,
                     std::move(provenance)});
  }
  return parts;
}

std::vector<Part> parts_of(const SimulateOptions& options, const Invocation& invocation,
                           const std::string& device) {
  if (!options.dataset.empty()) return parts_of_data_set(options, invocation, device);
  std::vector<Part> parts;
  for (const std::string& name : object_names(options))
    for (scene::ObjectSpec& object : objects_of(name, options.scene.activity)) {
      if (std::ranges::any_of(parts,
                              [&](const Part& p) { return p.scene.object.name == object.name; }))
        throw usage_error(fmt::format("'{}' is asked for twice", object.name),
                          "name each object once");
      scene::SceneOptions scene = options.scene;
      scene.object = std::move(object);
      Provenance provenance = provenance_of(scene, invocation, device);
      if (name.ends_with(".toml")) provenance.add_input(name);
      parts.push_back({std::move(scene), options.output, std::move(provenance)});
    }
  if (parts.size() > 1)
    for (Part& part : parts) part.output /= part.scene.object.name + ".h5";
  return parts;
}

/// What a recording follows from, whatever it is called.
nlohmann::json origin_of(const Provenance& provenance) {
  nlohmann::json origin{{"options", provenance.options}, {"version", provenance.version}};
  for (const char* harmless : {"resume", "output"}) origin["options"].erase(harmless);
  for (const auto& input : provenance.inputs) origin["inputs"].push_back(input.sha256);
  return origin;
}

/// Whether the recording is there already. Throws usage_error if another one is.
bool is_there(const Part& part, const SimulateOptions& options) {
  if (!options.resume || !std::filesystem::exists(part.output)) return false;
  const RecordingReader reader(part.output);
  if (origin_of(reader.recording().provenance) == origin_of(part.provenance)) return true;
  throw usage_error(fmt::format("{} was made with other options", part.output.string()),
                    "give those, another folder, or --overwrite without --resume");
}

void print_summary(const scene::SimulationSummary& summary, const std::string& output) {
  fmt::print(
      "{}: {} clips ({} dropped the object), {} glove frames, {} camera frames, {} board views\n",
      output, summary.clips, summary.dropped_clips, summary.glove_frames, summary.camera_frames,
      summary.board_views);
}

std::uint64_t minutes_of(std::span<const Part> parts) {
  double minutes = 0.0;
  for (const Part& part : parts) minutes += std::ceil(part.scene.minutes);
  return static_cast<std::uint64_t>(minutes);
}

ExitCode run(const SimulateOptions& given, const Invocation& invocation) {
  SimulateOptions options = given;
  options.scene.parameters = scene::parse_parameters(given.assume);
  std::optional<Runtime> runtime;
  if (options.rendered()) runtime.emplace(usable_device(invocation.device));
  auto parts = parts_of(options, invocation, runtime ? runtime->device().name : "");
  std::erase_if(parts, [&](const Part& part) { return is_there(part, options); });
  if (!options.resume)
    for (const Part& part : parts) OutputFile(part.output, invocation.overwrite);
  nlohmann::json rows = nlohmann::json::array();
  Progress progress("simulated minutes", minutes_of(parts));
  for (Part& part : parts) {
    const auto summary =
        scene::simulate_recording(part.scene, runtime ? &*runtime : nullptr, part.output,
                                  invocation.overwrite, std::move(part.provenance));
    if (parts.size() > 1) progress.advance(minutes_of({&part, 1}), part.output.string());
    rows.push_back(to_json(summary, part.output.string()));
    if (!invocation.json) print_summary(summary, part.output.string());
  }
  if (invocation.json)
    fmt::print("{}\n", (rows.size() == 1 ? rows[0] : nlohmann::json{{"recordings", rows}}).dump(2));
  return ExitCode::done;
}

}  // namespace

Command simulate_command() {
  return make_command<SimulateOptions>(
      "simulate", "simulate somebody with a tactile glove before an RGBD camera",
      {"touchtrace simulate wave.h5 --activity wave --object ball --minutes 2",
       "touchtrace simulate throw.h5 --activity throw --width 640 --height 480 --seed 7",
       "touchtrace simulate touch.h5 --minutes 10 --no-images --imu",
       "touchtrace simulate wave --object seen --minutes 5 --resume",
       "touchtrace simulate other_glove.h5 --glove 2 --assume glove-gain=0.5 wave-period=0.5:1.5",
       "touchtrace simulate paper --dataset paper --resume",
       "touchtrace simulate mixed --object bottle-half,my_mug.toml --config scene.toml"},
      run, {.device = true, .overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
