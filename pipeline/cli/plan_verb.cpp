#include <fmt/core.h>

#include <map>
#include <set>

#include "engine/train/tuning_file.h"
#include "engine/train/update_plan.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/cli/verbs.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/scene.h"
#include "pipeline/study/convolution_options.h"
#include "pipeline/study/plan.h"

namespace touchtrace::cli {
namespace {

struct PlanOptions {
  std::string recording, activity = "wave";
  std::vector<std::string> objects;
  bool without_touch = false;
  std::string dynamics = "mlp", object_encoder = "auto";
  int window = 10, resolution = 32, sequences = 8, steps = 20;
  study::ConvolutionOptions convolutions;
};

void describe(OptionSet& set, PlanOptions& o) {
  set.text("recording", o.recording,
           "recording to plan for; it says which activity and objects there are");
  set.text("activity", o.activity, "activity to simulate where no recording is given");
  set.texts("object", o.objects, "objects to simulate where no recording is given (default: ball)");
  set.flag("without-touch", o.without_touch, "only the baseline that sees no tactile frame");
  set.choice("dynamics", o.dynamics,
             "what predicts the next state: the paper's MLP, or a GRU that remembers",
             {"mlp", "gru"});
  set.choice("object-encoder", o.object_encoder,
             "what tells the model which object is in hand; auto: nothing for one object, frozen "
             "embeddings for several",
             {"auto", "none", "frozen", "joint"});
  set.integer("window", o.window, "tactile frames in a window, M", 1, 32);
  set.integer("resolution", o.resolution, "rows and columns of a tactile frame", 6, 64);
  describe(set, o.convolutions);
  set.integer("sequences", o.sequences, "roll-outs in a batch", 1, 4096);
  set.integer("steps", o.steps, "steps of a roll-out in training", 1, 200);
}

void read_recording(const std::string& path, study::PlanWishes& wishes) {
  const RecordingReader reader(path);
  const Recording& recording = reader.recording();
  std::set<std::string> objects;
  for (const auto& clip : recording.clips) objects.insert(clip.object);
  wishes.activity = recording.activity;
  wishes.objects.assign(objects.begin(), objects.end());
  wishes.simulated = false;
  if (!recording.gloves.empty())
    wishes.live = live_cells(recording.gloves.front().info, wishes.rows, wishes.cols);
}

study::PlanWishes wishes_of(const PlanOptions& options) {
  study::PlanWishes wishes;
  wishes.activity = options.activity;
  if (!options.objects.empty()) wishes.objects = options.objects;
  wishes.touch = !options.without_touch;
  wishes.dynamics = options.dynamics;
  wishes.object_encoder = options.object_encoder;
  wishes.window_frames = options.window;
  wishes.rows = wishes.cols = options.resolution;
  wishes.tactile_kernel = options.convolutions.kernel_size();
  wishes.tactile_strides = options.convolutions.stride_sizes();
  if (!options.recording.empty()) read_recording(options.recording, wishes);
  return wishes;
}

std::vector<PlannedLaunch> launches_of(const PlanOptions& options, const ModelSpec& model,
                                       const LiveTaxels& live, const std::string& device) {
  Runtime runtime(usable_device(device));
  return launches_of_update(runtime, model, options.sequences, options.steps, live,
                            read_tuning(tuning_path(), runtime.device()));
}

/// Launches of one kernel, or all.
struct LaunchSum {
  int launches = 0, tuned = 0;
  LaunchCost cost;

  void add(const PlannedLaunch& launch) {
    ++launches, tuned += launch.tuned ? 1 : 0;
    cost.flops += launch.cost.flops, cost.bytes += launch.cost.bytes;
  }
};

void print_row(const std::string& kernel, const LaunchSum& sum) {
  const auto count_or_dash = [](int count) { return count > 0 ? fmt::format("{}", count) : "-"; };
  fmt::print("  {:<28} {:>9} {:>6} {:>10} {:>9.1f}\n", kernel, sum.launches,
             count_or_dash(sum.tuned),
             sum.cost.flops > 0.0 ? fmt::format("{:.2f}", 1e-6 * sum.cost.flops) : "-",
             sum.cost.bytes / (1 << 20));
}

/// One row a kernel, in the order in which they are first queued.
void print_launches(const std::vector<PlannedLaunch>& launches) {
  std::vector<std::string> order;
  std::map<std::string, LaunchSum> rows;
  LaunchSum total;
  for (const auto& launch : launches) {
    if (!rows.contains(launch.kernel)) order.push_back(launch.kernel);
    rows[launch.kernel].add(launch);
    total.add(launch);
  }
  fmt::print("  {:<28} {:>9} {:>6} {:>10} {:>9}\n", "kernel", "launches", "tuned", "MFLOP", "MiB");
  for (const auto& kernel : order) print_row(kernel, rows[kernel]);
  print_row("all", total);
}

nlohmann::json launches_json(const std::vector<PlannedLaunch>& launches) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [kernel, cost, tuned] : launches)
    rows.push_back(
        {{"kernel", kernel}, {"flops", cost.flops}, {"bytes", cost.bytes}, {"tuned", tuned}});
  return rows;
}

ExitCode run(const PlanOptions& options, const Invocation& invocation) {
  const study::PlanWishes wishes = wishes_of(options);
  const study::Plan plan = study::make_plan(wishes);
  const auto launches = launches_of(options, plan.model, wishes.live, invocation.device);
  if (invocation.json) {
    auto document = study::plan_json(wishes, plan);
    document["launches"] = launches_json(launches);
    fmt::print("{}\n", document.dump(2));
    return ExitCode::done;
  }
  for (const auto& item : plan.items)
    fmt::print("{} {:<10} {:<34} {}\n", item.included ? "+" : "-", item.stage, item.part, item.why);
  fmt::print("+ is built and run, - is left out\n\nan update of {} sequences of {} steps:\n",
             options.sequences, options.steps);
  print_launches(launches);
  return ExitCode::done;
}

}  // namespace

Verb plan_verb() {
  return make_verb<PlanOptions>("plan", "say what will be built and run, what is left out, and why",
                                {"touchtrace plan --activity throw --object ball",
                                 "touchtrace plan --recording wave.h5 --without-touch --json"},
                                run);
}

}  // namespace touchtrace::cli
