#include <fmt/core.h>

#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/study/sessions.h"
#include "pipeline/study/training.h"

namespace touchtrace::cli {
namespace {

ExitCode run(const study::TrainingOptions& options, const Invocation& invocation) {
  Runtime runtime(usable_device(invocation.device), accuracy_of(options.accuracy));
  Provenance provenance = start_provenance("touchtrace/model/1", "train");
  provenance.options = invocation.options;
  const auto files = study::pair_files(options.recordings, options.labels);
  for (const auto& pair : files) {
    provenance.add_input(pair.recording);
    provenance.add_input(pair.labels);
  }
  const Dataset data = load_dataset(files, options.model.resolution);
  // of the model, by which reports name it
  provenance.options["resolution"] = data.rows == data.cols ? data.rows : 0;
  const auto card =
      study::train_model(runtime, data, options, std::move(provenance), invocation.overwrite);
  const auto* saved = card.saved_entry();
  if (invocation.json)
    fmt::print(
        "{}\n",
        nlohmann::json{{"output", options.output}, {"model", card.name()}, {"card", card}}.dump(2));
  else
    fmt::print("{}: {} model of {}, {} updates on {} in {:.1f} s, {}\n", options.output,
               card.name(), card.activity, options.optimizer.updates, runtime.device().name,
               card.provenance.wall_seconds,
               saved ? fmt::format("validation L1@20 {:.3f}", saved->validation_l1_at_20)
                     : "without validation, as there are too few clips: the last weights");
  return ExitCode::done;
}

}  // namespace

Command train_command() {
  return make_command<study::TrainingOptions>(
      "train", "train a model of hand and object motion from touch",
      {"touchtrace train --recording wave.h5 --output wave_full.safetensors",
       "touchtrace train --recording wave.h5 --labels wave.labels.h5 --without-touch --output "
       "wave_without_touch.safetensors"},
      run, {.device = true, .overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
