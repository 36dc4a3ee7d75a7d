#include <fmt/core.h>

#include <set>

#include "pipeline/cli/commands.h"
#include "pipeline/cli/update_table.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/study/model_options.h"
#include "pipeline/study/plan.h"

namespace touchtrace::cli {
namespace {

struct PlanOptions {
  std::string recording;
  std::vector<std::string> objects;
  study::ModelOptions model;
  int sequences = 8, steps = 20;
  bool measure = false;
};

void describe(OptionSet& set, PlanOptions& o) {
  set.group("Data");
  set.text("recording", o.recording, "recording to plan for, with its glove and objects")
      .value("FILE");
  set.texts("object", o.objects, "objects to simulate if there is no recording; default: ball")
      .value("NAME");
  describe(set, o.model);
  set.group("Update");
  set.integer("sequences", o.sequences, "roll-outs per batch", 1, 4096);
  set.integer("steps", o.steps, "steps per roll-out", 1, 200);
  set.flag("measure", o.measure, "run an update and measure each of its launches");
}

study::PlanRequest request_of(const PlanOptions& options) {
  study::PlanRequest request;
  if (options.recording.empty())
    for (const auto& object : options.objects) scene::load_object(object);  // throws if unknown
  if (!options.objects.empty()) request.objects = options.objects;
  GloveInfo glove;  // as the simulated one
  if (!options.recording.empty()) {
    const RecordingReader reader(options.recording);
    std::set<std::string> objects;
    for (const auto& clip : reader.recording().clips) objects.insert(clip.object);
    request.objects.assign(objects.begin(), objects.end());
    request.is_simulated = false;
    if (!reader.recording().gloves.empty()) glove = reader.recording().gloves.front().info;
  }
  const auto [rows, cols] = image_shape(glove, options.model.resolution);
  request.spec = make_spec(options.model, rows, cols, request.objects.size());
  if (!glove.mask.empty()) request.live = live_cells(glove, rows, cols);
  return request;
}

nlohmann::json request_json(const study::PlanRequest& request) {
  auto items = nlohmann::json::array();
  for (const auto& item : study::plan_items(request))
    items.push_back({{"stage", item.stage},
                     {"part", item.part},
                     {"included", item.included},
                     {"why", item.why}});
  return {{"objects", request.objects}, {"model", request.spec}, {"items", items}};
}

/// `update`: planned or measured.
void show(const study::PlanRequest& request, const PlanOptions& options, const auto& update,
          bool as_json) {
  if (as_json) {
    auto document = request_json(request);
    document.update(update_json(update));
    fmt::print("{}\n", document.dump(2));
    return;
  }
  for (const auto& item : study::plan_items(request))
    fmt::print("{} {:<10} {:<34} {}\n", item.included ? "+" : "-", item.stage, item.part, item.why);
  fmt::print("+ needed, - skipped\n\nupdate of {} sequences of {} steps:\n", options.sequences,
             options.steps);
  print_update(update);
}

ExitCode run(const PlanOptions& o, const Invocation& invocation) {
  const study::PlanRequest request = request_of(o);
  Runtime runtime(usable_device(invocation.device));
  const auto show_of_update = [&](const auto& looked_into) {
    show(request, o, looked_into(runtime, request.spec, o.sequences, o.steps, request.live),
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
      {"touchtrace plan --object ball",
       "touchtrace plan --recording wave.h5 --without-touch --json",
       "touchtrace plan --object ball can --object-encoder joint --measure"},
      run, {.device = true, .quiet = true});
}

}  // namespace touchtrace::cli
