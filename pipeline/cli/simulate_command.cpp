#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/base/files.h"
#include "engine/base/named.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/label_simulated.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/data_sets.h"
#include "pipeline/scene/simulate/oracle.h"
#include "pipeline/scene/simulate/simulate.h"
#include "pipeline/study/sessions.h"

namespace touchtrace::cli {
namespace {

struct SimulateOptions {
  scene::SceneOptions scene;
  std::string output, object, dataset, glove_model = "default";
  std::vector<std::string> settings;
  double share = 1.0;
  label::LabelOptions labelling;
  bool no_images = false, images = false, label = false, resume = false;

  bool renders() const { return label || (dataset.empty() ? !no_images : images); }
};

void describe(OptionSet& set, SimulateOptions& o) {
  scene::SceneOptions& s = o.scene;
  set.input("output", o.output, "recording (.h5); a folder for several objects or --dataset");
  set.choice("activity", s.activity, "what the hand does", scene::activity_names());
  set.text("object", o.object,
           "object names, roles (see `touchtrace objects`) or TOML files, separated by commas; "
           "default: the usual object of the activity");
  set.number("minutes", s.minutes,
             "recorded time per object, rounded to whole clips, at least one [min]", 0.01, 1e4)
      .value("MINUTES");
  set.number("clip-s", s.clip_s, "mean length of a clip; each begins with a new grasp [s]", 1.0,
             600.0);
  set.number("clip-spread", s.clip_spread, "largest relative deviation of a clip's length", 0.0,
             0.9);
  set.number("pause-s", s.pause_s, "shortest unrecorded time between clips [s]", 0.0, 600.0)
      .value("SECONDS");
  set.integer("width", s.image_width, "width of colour and depth images, a multiple of 16 [px]",
              160, 1280);
  set.integer("height", s.image_height, "height of colour and depth images [px]", 120, 960);
  set.integer("board-views", s.board_views, "number of chessboard views for the calibration", 0,
              200);
  set.integer("glove", s.glove,
              "number of the glove instance; each has its own gains, dead taxels and drift", 1,
              1000);
  set.choice("glove-model", o.glove_model,
             "kind of glove; actionsense: a high reading at rest and weak signals, as in published "
             "frames; --set changes single parameters of it",
             scene::glove_model_names());
  set.choice("sensed", s.sensed,
             "what the glove's frames hold; force, acceleration: exact values, which show what "
             "limits a model",
             scene::sensed_names());
  set.flag("imu", s.inertial_unit,
           "inertial unit on the back of the hand: specific force, angular velocity, orientation");
  set.texts("set", o.settings, "scene parameters (see `touchtrace parameters`)")
      .value("NAME=VALUE");
  set.text("dataset", o.dataset,
           "paper: folder of recordings with the activities, objects and frame counts of the "
           "paper's table, without images unless --images or --label")
      .value("NAME");
  set.number("share", o.share, "fraction of the data set's frames", 1e-4, 1.0);
  set.flag("images", o.images, "render the data set's images");
  set.flag("label", o.label,
           "calibrate and label from rendered images that are not stored: X.h5, X.calibration and "
           "X.labels.h5");
  label::describe_tracker(set, o.labelling).help = "tracker of --label; component: faster";
  set.flag("no-images", o.no_images, "glove and truth only, no images");
  set.flag("resume", o.resume, "keep existing recordings made with the same options");
  set.seed("seed", s.seed, "seed of all random numbers");
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

/// One recording to simulate.
struct Job {
  scene::SceneOptions scene;
  std::filesystem::path output;
  Provenance provenance;
};

/// Returns the object of that name or TOML file, or the objects of that role that the activity
/// accepts. Throws usage_error if there is none.
std::vector<scene::ObjectSpec> select_objects(const std::string& name,
                                              const std::string& activity) {
  const scene::ActivityRow& row = scene::find_activity(activity);
  std::vector<scene::ObjectSpec> named, accepted;
  for (const scene::ObjectSpec& object : scene::objects())
    if (scene::role_name(object.role) == name) named.push_back(object);
  if (named.empty()) named.push_back(scene::load_object(name));
  std::ranges::copy_if(named, std::back_inserter(accepted), row.accepts);
  if (accepted.empty()) scene::require_compatible(row, named.front());
  return accepted;
}

std::vector<std::string> object_names(const SimulateOptions& options) {
  if (options.object.empty()) return {scene::default_object(options.scene.activity).name};
  return split_text(options.object, ',');
}

Provenance make_provenance(const scene::SceneOptions& scene, const Invocation& invocation,
                           const std::string& device) {
  Provenance provenance = start_provenance("touchtrace/recording/2", "simulate");
  provenance.options = invocation.options;
  provenance.options["activity"] = scene.activity;
  provenance.options["object"] = scene.object.name;
  provenance.options["minutes"] = scene.minutes;
  provenance.options["seed"] = scene.seed;
  provenance.options["parameters"] = scene::parameters_json(scene.parameters);
  provenance.options.erase("set");
  provenance.seed = scene.seed;
  provenance.device = device;
  return provenance;
}

std::vector<Job> data_set_jobs(const SimulateOptions& options, const Invocation& invocation,
                               const std::string& device) {
  if (!options.object.empty())
    throw usage_error("--object cannot be combined with --dataset", "leave out one of them");
  std::vector<Job> jobs;
  for (auto& planned :
       plan_recordings(scene::find_data_set(options.dataset), options.scene, options.share)) {
    Provenance provenance = make_provenance(planned.scene, invocation, device);
    jobs.push_back({std::move(planned.scene), std::filesystem::path(options.output) / planned.file,
                    std::move(provenance)});
  }
  return jobs;
}

std::vector<Job> make_jobs(const SimulateOptions& options, const Invocation& invocation,
                           const std::string& device) {
  if (!options.dataset.empty()) return data_set_jobs(options, invocation, device);
  std::vector<Job> jobs;
  for (const std::string& name : object_names(options))
    for (scene::ObjectSpec& object : select_objects(name, options.scene.activity)) {
      if (std::ranges::any_of(jobs,
                              [&](const Job& job) { return job.scene.object.name == object.name; }))
        throw usage_error(fmt::format("object '{}' is given twice", object.name),
                          "give each object once");
      scene::SceneOptions scene = options.scene;
      scene.object = std::move(object);
      Provenance provenance = make_provenance(scene, invocation, device);
      if (name.ends_with(".toml")) provenance.add_input(name);
      jobs.push_back({std::move(scene), options.output, std::move(provenance)});
    }
  if (jobs.size() > 1)
    for (Job& job : jobs) job.output /= job.scene.object.name + ".h5";
  return jobs;
}

/// Everything that determines a recording's content.
nlohmann::json origin(const Provenance& provenance) {
  nlohmann::json json{{"options", provenance.options}, {"version", provenance.version}};
  for (const char* irrelevant : {"resume", "output"}) json["options"].erase(irrelevant);
  for (const auto& input : provenance.inputs) json["inputs"].push_back(input.sha256);
  return json;
}

/// Returns whether the job's recording exists. Throws usage_error if it was made with other
/// options.
bool is_done(const Job& job, const SimulateOptions& options) {
  if (!options.resume || !std::filesystem::exists(job.output)) return false;
  const RecordingReader reader(job.output);
  if (origin(reader.recording().provenance) == origin(job.provenance))
    return !options.label || std::filesystem::exists(labels_path_of(job.output));
  throw usage_error(fmt::format("{} was made with other options", job.output.string()),
                    "give the same options, another folder, or --overwrite without --resume");
}

void print_summary(const scene::SimulationSummary& summary, const std::string& output) {
  fmt::print(
      "{}: {} clips (object dropped in {}), {} glove frames, {} camera frames, {} board views\n",
      output, summary.clips, summary.dropped_clips, summary.glove_frames, summary.camera_frames,
      summary.board_views);
}

std::uint64_t total_minutes(std::span<const Job> jobs) {
  double minutes = 0.0;
  for (const Job& job : jobs) minutes += std::ceil(job.scene.minutes);
  return static_cast<std::uint64_t>(minutes);
}

scene::SimulationSummary run_job(const Job& job, const SimulateOptions& options, Runtime* runtime,
                                 bool overwrite) {
  return options.label
             ? simulate_labelled(job.scene, *runtime, options.labelling, job.output, overwrite,
                                 job.provenance)
             : scene::simulate_recording(job.scene, runtime, job.output, overwrite, job.provenance);
}

/// Runs a job. One of several whose images cannot be labelled is skipped with a warning: nullopt.
std::optional<scene::SimulationSummary> try_job(const Job& job, const SimulateOptions& options,
                                                Runtime* runtime, bool overwrite, bool is_only) {
  try {
    return run_job(job, options, runtime, overwrite);
  } catch (const Error& error) {
    if (error.code() != ExitCode::data || is_only) throw;
    fmt::print(stderr, "warning: {} is skipped: {}\n", job.output.string(), error.what());
    return std::nullopt;
  }
}

ExitCode run(const SimulateOptions& given, const Invocation& invocation) {
  SimulateOptions options = given;
  const auto& glove = find_named(scene::glove_models(), "glove model", options.glove_model);
  options.settings.insert(options.settings.begin(), glove.settings.begin(), glove.settings.end());
  options.scene.parameters = scene::parse_parameters(options.settings);
  std::optional<Runtime> runtime;
  if (options.renders()) runtime.emplace(usable_device(invocation.device));
  auto jobs = make_jobs(options, invocation, runtime ? runtime->device().name : "");
  std::erase_if(jobs, [&](const Job& job) { return is_done(job, options); });
  if (!options.resume)
    for (const Job& job : jobs) OutputFile(job.output, invocation.overwrite);
  nlohmann::json rows = nlohmann::json::array();
  Progress progress("simulated minutes", total_minutes(jobs));
  for (const Job& job : jobs) {
    const auto summary = try_job(job, options, runtime ? &*runtime : nullptr,
                                 invocation.overwrite || options.resume, jobs.size() == 1);
    if (summary) rows.push_back(to_json(*summary, job.output.string()));
    if (summary && !invocation.json) print_summary(*summary, job.output.string());
    if (jobs.size() > 1) progress.advance(total_minutes({&job, 1}), job.output.string());
  }
  if (invocation.json)
    fmt::print("{}\n", (rows.size() == 1 ? rows[0] : nlohmann::json{{"recordings", rows}}).dump(2));
  if (rows.size() < jobs.size())
    throw data_error(fmt::format("{} of {} recordings cannot be labelled",
                                 jobs.size() - rows.size(), jobs.size()),
                     "simulate them again with more --minutes; the others are complete");
  return ExitCode::done;
}

}  // namespace

Command simulate_command() {
  return make_command<SimulateOptions>(
      "simulate", "simulate a hand with a tactile glove before an RGB-D camera",
      {"touchtrace simulate wave.h5 --activity wave --object ball --minutes 2",
       "touchtrace simulate throw.h5 --activity throw --width 640 --height 480 --seed 7",
       "touchtrace simulate touch.h5 --minutes 10 --no-images --imu",
       "touchtrace simulate wave --object seen --minutes 5 --resume",
       "touchtrace simulate other_glove.h5 --glove 2 --set glove-gain=0.5 wave-period=0.5:1.5",
       "touchtrace simulate paper --dataset paper --label --resume",
       "touchtrace simulate mixed --object bottle-half,my_mug.toml --config scene.toml"},
      run, {.device = true, .overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
