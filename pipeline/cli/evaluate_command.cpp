#include <fmt/core.h>

#include <cmath>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/usable_device.h"
#include "pipeline/study/evaluation.h"
#include "pipeline/study/sessions.h"

namespace touchtrace::cli {
namespace {

using nlohmann::json;

std::string number(const json& value) {
  return value.is_number() && std::isfinite(value.get<double>())
             ? fmt::format("{:.3f}", value.get<double>())
             : "-";
}

void print_table(const json& document) {
  fmt::print("{:<10} {:<12} {:<7} {:<17} {:>8} {:>8} {:>10} {:>9}\n", "activity", "object", "split",
             "model", "L1@20", "L1@50", "Hausdorff", "coverage");
  for (const auto& row : document.at("results"))
    fmt::print("{:<10} {:<12} {:<7} {:<17} {:>8} {:>8} {:>10} {:>9}\n",
               row.at("activity").get<std::string>(), row.at("object").get<std::string>(),
               row.at("split").get<std::string>(), row.at("model").get<std::string>(),
               number(row.at("l1_at_20")), number(row.at("l1_at_50")), number(row.at("hausdorff")),
               number(row.at("coverage")));
  fmt::print(
      "evaluated against {}; L1 and Hausdorff in standard deviations of the training labels\n",
      document.at("against") == "truth" ? "the truth" : "the labels");
  for (const auto& row : document.at("differences"))
    fmt::print("{} {}: full - {}, {}: {} ({} to {})\n", row.at("activity").get<std::string>(),
               row.at("object").get<std::string>(), row.at("other").get<std::string>(),
               row.at("metric").get<std::string>(), number(row.at("mean")), number(row.at("low")),
               number(row.at("high")));
}

ExitCode run(const study::EvaluationOptions& options, const Invocation& invocation) {
  const Stopwatch watch;
  if (!options.output.empty()) OutputFile(options.output, invocation.overwrite);
  Runtime runtime(usable_device(invocation.device), accuracy_of(options.accuracy));
  Provenance provenance = start_provenance("touchtrace/metrics/1", "evaluate");
  provenance.options = invocation.options;
  provenance.seed = options.seed;
  provenance.device = runtime.device().name;
  std::vector<study::LoadedModel> models;
  for (const auto& path : options.models) {
    models.push_back(study::load_model(runtime, path));
    provenance.add_input(path);
  }
  const auto sessions = study::load_sessions(study::pair_files(options.recordings, options.labels),
                                             models, options.against);
  json document = study::evaluate_models(sessions, models, options);
  for (const auto* paths : {&options.recordings, &options.labels})
    for (const auto& path : *paths) provenance.add_input(path);
  watch.stop(provenance);
  document["device"] = runtime.device().name;
  document["provenance"] = provenance;
  if (!options.output.empty())
    write_file(options.output, document.dump(1) + "\n", invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", json{{"results", document["results"]}}.dump(2));
  else
    print_table(document);
  return ExitCode::done;
}

}  // namespace

Command evaluate_command() {
  return make_command<study::EvaluationOptions>(
      "evaluate", "evaluate models and the baseline Random on held-out clips",
      {"touchtrace evaluate --recording wave.h5 --labels wave.labels.h5 --model "
       "wave_full.safetensors "
       "wave_without_touch.safetensors --output metrics.json",
       "touchtrace evaluate --recording wave.h5 --labels wave.labels.h5 --model "
       "wave_full.safetensors --json"},
      run, {.device = true, .overwrite = true});
}

}  // namespace touchtrace::cli
