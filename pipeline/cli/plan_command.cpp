#include <fmt/core.h>

#include <set>

#include "engine/train/tuning_file.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/update_table.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/base/scene.h"
#include "pipeline/study/convolution_options.h"
#include "pipeline/study/plan.h"

namespace touchtrace::cli {
namespace {

struct PlanOptions {
  std::string recording, activity = "wave";
  std::vector<std::string> objects;
  bool without_touch = false, measure = false;
  std::string dynamics = "mlp", object_encoder = "auto";
  int window = 10, resolution = 32, sequences = 8, steps = 20;
  study::ConvolutionOptions convolutions;
};

void describe(OptionSet& set, PlanOptions& o) {
  set.group("Data");
  set.text("recording", o.recording, "recording to plan for, with its activity and objects")
      .value("FILE");
  set.text("activity", o.activity, "activity to simulate if there is no recording").value("NAME");
  set.texts("object", o.objects, "objects to simulate if there is no recording; default: ball")
      .value("NAME");
  set.group("Model");
  set.flag("without-touch", o.without_touch, "baseline without tactile input");
  set.choice("dynamics", o.dynamics, "state transition model", {"mlp", "gru"});
  set.choice("object-encoder", o.object_encoder, "auto: none for one object, else frozen",
             {"auto", "none", "frozen", "joint"});
  set.integer("window", o.window, "tactile frames per window, 1-32", 1, 32);
  set.integer("resolution", o.resolution, "tactile rows and columns, 6-64", 6, 64);
  describe(set, o.convolutions);
  set.group("Update");
  set.integer("sequences", o.sequences, "roll-outs per batch", 1, 4096);
  set.integer("steps", o.steps, "steps per roll-out", 1, 200);
  set.flag("measure", o.measure, "run an update and measure each of its launches");
}

void read_recording(const std::string& path, study::PlanRequest& request) {
  const RecordingReader reader(path);
  const Recording& recording = reader.recording();
  std::set<std::string> objects;
  for (const auto& clip : recording.clips) objects.insert(clip.object);
  request.activity = recording.activity;
  request.objects.assign(objects.begin(), objects.end());
  request.simulated = false;
  if (!recording.gloves.empty())
    request.live = live_cells(recording.gloves.front().info, request.rows, request.cols);
}

study::PlanRequest plan_request(const PlanOptions& options) {
  study::PlanRequest request;
  request.activity = options.activity;
  if (!options.objects.empty()) request.objects = options.objects;
  request.touch = !options.without_touch;
  request.dynamics = options.dynamics;
  request.object_encoder = options.object_encoder;
  request.window_frames = options.window;
  request.rows = request.cols = options.resolution;
  request.tactile_kernel = options.convolutions.kernel_size();
  request.tactile_strides = options.convolutions.stride_sizes();
  if (!options.recording.empty()) read_recording(options.recording, request);
  return request;
}

/// `update`: planned or measured.
void show(const study::PlanRequest& request, const study::Plan& plan, const PlanOptions& options,
          const auto& update, bool as_json) {
  if (as_json) {
    auto document = study::plan_json(request, plan);
    document.update(update_json(update));
    fmt::print("{}\n", document.dump(2));
    return;
  }
  for (const auto& item : plan.items)
    fmt::print("{} {:<10} {:<34} {}\n", item.included ? "+" : "-", item.stage, item.part, item.why);
  fmt::print("+ needed, - skipped\n\nupdate of {} sequences of {} steps:\n", options.sequences,
             options.steps);
  print_update(update);
}

ExitCode run(const PlanOptions& o, const Invocation& invocation) {
  const study::PlanRequest request = plan_request(o);
  const study::Plan plan = study::make_plan(request);
  Runtime runtime(usable_device(invocation.device));
  const auto tuning = read_tuning(tuning_path(), runtime.device());
  const auto show_of_update = [&](const auto& looked_into) {
    show(request, plan, o,
         looked_into(runtime, plan.model, o.sequences, o.steps, request.live, tuning),
         invocation.json);
  };
  if (o.measure)
    show_of_update(measure_update);
  else
    show_of_update(launches_of_update);
  return ExitCode::done;
}

}  // namespace

Command plan_command() {
  return make_command<PlanOptions>(
      "plan", "list what a recording needs: stages, kernels, and what is skipped and why",
      {"touchtrace plan --activity throw --object ball",
       "touchtrace plan --recording wave.h5 --without-touch --json",
       "touchtrace plan --object ball can --object-encoder joint --measure"},
      run, {.device = true, .quiet = true});
}

}  // namespace touchtrace::cli
