#include <fmt/core.h>

#include <set>

#include "pipeline/cli/verbs.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/scene.h"
#include "pipeline/study/plan.h"

namespace touchtrace::cli {
namespace {

struct PlanOptions {
  std::string recording, activity = "wave";
  std::vector<std::string> objects;
  bool without_touch = false;
  int window = 10, resolution = 32;
};

void describe(OptionSet& set, PlanOptions& o) {
  set.text("recording", o.recording,
           "recording to plan for; it says which activity and objects there are");
  set.text("activity", o.activity, "activity to simulate where no recording is given");
  set.texts("object", o.objects, "objects to simulate where no recording is given (default: ball)");
  set.flag("without-touch", o.without_touch, "only the baseline that sees no tactile frame");
  set.integer("window", o.window, "tactile frames in a window, M", 1, 32);
  set.integer("resolution", o.resolution, "rows and columns of a tactile frame", 6, 64);
}

void read_recording(const std::string& path, study::PlanWishes& wishes) {
  const RecordingReader reader(path);
  const Recording& recording = reader.recording();
  std::set<std::string> objects;
  for (const auto& clip : recording.clips) objects.insert(clip.object);
  wishes.activity = recording.activity;
  wishes.objects.assign(objects.begin(), objects.end());
  wishes.simulated = false;
}

study::PlanWishes wishes_of(const PlanOptions& options) {
  study::PlanWishes wishes;
  wishes.activity = options.activity;
  if (!options.objects.empty()) wishes.objects = options.objects;
  wishes.touch = !options.without_touch;
  wishes.window_frames = options.window;
  wishes.rows = wishes.cols = options.resolution;
  if (!options.recording.empty()) read_recording(options.recording, wishes);
  return wishes;
}

ExitCode run(const PlanOptions& options, const Invocation& invocation) {
  const study::PlanWishes wishes = wishes_of(options);
  const study::Plan plan = study::make_plan(wishes);
  if (invocation.json) {
    fmt::print("{}\n", study::plan_json(wishes, plan).dump(2));
    return ExitCode::done;
  }
  for (const auto& item : plan.items)
    fmt::print("{} {:<10} {:<34} {}\n", item.included ? "+" : "-", item.stage, item.part, item.why);
  fmt::print("+ is built and run, - is left out\n");
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
