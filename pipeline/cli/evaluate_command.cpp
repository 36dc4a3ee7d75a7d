#include <fmt/core.h>

#include <cmath>
#include <map>

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

constexpr const char* row_format =
    "{:<10} {:<10} {:<7} {:<17} {:>5} {:>5} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9}\n";

std::string text(const json& row, const char* key) { return row.at(key).get<std::string>(); }

std::string count(const json& value) {
  return value == 0 ? "-" : fmt::format("{}", value.get<int>());
}

/// "-0.194 (-0.213 to -0.175)"
std::string interval(const json& metric) {
  return fmt::format("{} ({} to {})", number(metric.at("mean")), number(metric.at("low")),
                     number(metric.at("high")));
}

void print_differences(const json& document) {
  for (const auto& row : document.at("differences")) {
    fmt::print("{} {}: {} - {}", text(row, "activity"), text(row, "object"), text(row, "model"),
               text(row, "other"));
    for (const auto& [metric, label] :
         {std::pair("l1_at_50", "L1@50"), std::pair("object_error_m_at_50", "object m"),
          std::pair("object_error_m_per_s_at_50", "object m/s")})
      fmt::print(", {} {}", label, interval(row.at("metrics").at(metric)));
    fmt::print("\n");
  }
}

void print_table(const json& document) {
  fmt::print(row_format, "activity", "object", "split", "model", "seeds", "clips", "L1@20", "L1@50",
             "Hausdorff", "coverage", "object m", "m/s");
  for (const auto& row : document.at("results"))
    fmt::print(row_format, text(row, "activity"), text(row, "object"), text(row, "split"),
               text(row, "model"), count(row.at("runs")), count(row.at("clips")),
               number(row.at("l1_at_20")), number(row.at("l1_at_50")), number(row.at("hausdorff")),
               number(row.at("coverage")), number(row.at("object_error_m_at_50")),
               number(row.at("object_error_m_per_s_at_50")));
  fmt::print(
      "evaluated against {}; L1 and Hausdorff in standard deviations of the training labels; "
      "object m, m/s: mean error of its position and velocity over 50 steps\n",
      document.at("against") == "truth" ? "the truth, shifted by the labels' mean offset"
                                        : "the labels");
  print_differences(document);
}

/// Provenance without inputs and times.
Provenance make_provenance(const study::EvaluationOptions& options, const Invocation& invocation,
                           const std::string& device) {
  Provenance provenance = start_provenance("touchtrace/metrics/2", "evaluate");
  provenance.options = invocation.options;
  provenance.seed = options.seed;
  provenance.device = device;
  return provenance;
}

void require_distinct(const std::vector<Provenance::Input>& models) {
  std::map<std::string, std::string> path_by_hash;
  for (const auto& model : models) {
    const auto [first, is_new] = path_by_hash.emplace(model.sha256, model.path);
    if (!is_new)
      throw usage_error(fmt::format("{} and {} are the same model", first->second, model.path),
                        "give each model once: a copy is not another seed");
  }
}

ExitCode run(const study::EvaluationOptions& options, const Invocation& invocation) {
  const Stopwatch watch;
  if (!options.output.empty()) OutputFile(options.output, invocation.overwrite);
  Runtime runtime(usable_device(invocation.device), accuracy_of(options.accuracy));
  Provenance provenance = make_provenance(options, invocation, runtime.device().name);
  std::vector<study::LoadedModel> models;
  for (const auto& path : options.models) {
    models.push_back(study::load_model(runtime, path));
    provenance.add_input(path);
  }
  require_distinct(provenance.inputs);
  const auto files = study::pair_files(options.recordings, options.labels);
  json document =
      study::evaluate_models(study::load_sessions(files, options.against), models, options);
  for (const auto& note : document.at("notes"))
    fmt::print(stderr, "note: {}\n", note.get<std::string>());
  for (const auto& pair : files)
    for (const auto& path : {pair.recording, pair.labels}) provenance.add_input(path);
  watch.stop(provenance);
  document["device"] = runtime.device().name;
  document["provenance"] = provenance;
  if (!options.output.empty())
    write_file(options.output, document.dump(1) + "\n", invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", json{{"against", document["against"]},
                            {"results", document["results"]},
                            {"differences", document["differences"]},
                            {"main_metrics", document["main_metrics"]},
                            {"notes", document["notes"]}}
                           .dump(2));
  else
    print_table(document);
  return ExitCode::done;
}

}  // namespace

Command evaluate_command() {
  return make_command<study::EvaluationOptions>(
      "evaluate", "evaluate models and baselines on held-out clips",
      {"touchtrace evaluate --recording wave.h5 --model wave_full.safetensors "
       "wave_without_touch.safetensors --output metrics.json",
       "touchtrace evaluate --recording wave.h5 --labels wave.labels.h5 --model "
       "wave_full.safetensors --json"},
      run, {.device = true, .overwrite = true});
}

}  // namespace touchtrace::cli
