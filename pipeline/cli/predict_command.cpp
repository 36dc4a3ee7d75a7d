#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/live_glove.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/study/prediction.h"

namespace touchtrace::cli {
namespace {

struct PredictOptions {
  study::PredictionOptions recording;
  LiveOptions live;
};

void describe(OptionSet& set, PredictOptions& o) {
  describe(set, o.recording);
  describe(set, o.live);
}

void check(const PredictOptions& options) {
  const bool is_live = !options.live.devices.glove.empty();
  const study::PredictionOptions& recorded = options.recording;
  if (is_live == !recorded.recording.empty())
    throw usage_error(
        is_live ? "--recording and --glove cannot be combined" : "nothing to predict from",
        "give either --recording FILE or --glove PORT");
  if (is_live && (!recorded.labels.empty() || recorded.restart_steps > 0))
    throw usage_error(
        "--labels and --restart-steps need a recording",
        "leave them out, or give --recording FILE: a live roll-out starts from the mean "
        "training state");
  if (is_live && !recorded.output.empty())
    throw usage_error("--output cannot be combined with --glove",
                      "redirect standard output: > FILE");
  if (!is_live && options.live.page) throw usage_error("--page needs --glove", "give --glove PORT");
}

void predict_recording(const study::PredictionOptions& options, const Invocation& invocation) {
  if (!options.output.empty()) OutputFile(options.output, invocation.overwrite);
  Runtime runtime(usable_device(invocation.device), accuracy_of(options.accuracy));
  std::string lines;
  study::predict(runtime, options, [&](const nlohmann::json& row) {
    if (options.output.empty())
      fmt::print("{}\n", row.dump());
    else
      lines += row.dump() + "\n";
  });
  if (!options.output.empty()) write_file(options.output, lines, invocation.overwrite);
}

ExitCode run(const PredictOptions& options, const Invocation& invocation) {
  check(options);
  if (options.live.devices.glove.empty()) {
    predict_recording(options.recording, invocation);
  } else {
    Runtime runtime(usable_device_for_small_steps(invocation.device),
                    accuracy_of(options.recording.accuracy));
    predict_live(runtime, options.recording.model, options.live);
  }
  return ExitCode::done;
}

}  // namespace

Command predict_command() {
  return make_command<PredictOptions>(
      "predict", "predict hand and object from a glove, recorded or live",
      {"touchtrace predict --model full.safetensors --recording my.h5 > prior.jsonl",
       "touchtrace predict --model full.safetensors --recording my.h5 --labels my.labels.h5 "
       "--restart-steps 50 --output my.jsonl",
       "touchtrace predict --model full.safetensors --glove /dev/ttyACM0 --glove-config glove.json "
       "--page > live.jsonl"},
      run, {.device = true, .overwrite = true, .quiet = true, .json = false});
}

}  // namespace touchtrace::cli
