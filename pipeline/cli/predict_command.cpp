#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/study/prediction.h"

namespace touchtrace::cli {
namespace {

ExitCode run(const study::PredictionOptions& options, const Invocation& invocation) {
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
  return ExitCode::done;
}

}  // namespace

Command predict_command() {
  return make_command<study::PredictionOptions>(
      "predict", "predict hand and object of a recording from its glove",
      {"touchtrace predict --model full.safetensors --recording my.h5 > prior.jsonl",
       "touchtrace predict --model full.safetensors --recording my.h5 --labels my.labels.h5 "
       "--restart-steps 50 --output my.jsonl"},
      run, {.device = true, .overwrite = true, .json = false});
}

}  // namespace touchtrace::cli
