#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/report/report.h"

namespace touchtrace::cli {
namespace {

struct ReportOptions {
  std::string folder, output;
  std::vector<std::string> metrics, labels, calibration, recording, figures;
};

void describe(OptionSet& set, ReportOptions& o) {
  set.path("output", o.output, "report (.html)").value("FILE");
  set.group("Inputs");
  set.text("folder", o.folder, "folder with artefacts, searched recursively").value("DIR");
  set.texts("metrics", o.metrics, "metrics files from `evaluate`").value("FILE");
  set.texts("labels", o.labels, "label files").value("FILE");
  set.texts("calibration", o.calibration, "calibration.json files").value("FILE");
  set.texts("recording", o.recording, "recordings, for their provenance").value("FILE");
  set.texts("figures", o.figures,
            "output of `touchtrace-verify AREA --json` or `scripts/bench AREA --json`")
      .value("FILE");
}

/// Adds files that must be valid.
void append(report::ReportInputs& inputs, std::vector<std::filesystem::path>& paths,
            const std::vector<std::string>& more) {
  paths.insert(paths.end(), more.begin(), more.end());
  for (const auto& path : more) inputs.found.erase(path);
}

void print_stages(const nlohmann::json& stages) {
  fmt::print("{:<12} {:<32} {:>9} {:>9}  {}\n", "command", "made", "seconds", "CPU s", "device");
  for (const auto& stage : stages)
    fmt::print("{:<12} {:<32} {:>9.1f} {:>9.1f}  {}\n", stage.at("command").get<std::string>(),
               stage.at("artefact").get<std::string>(), stage.at("wall_seconds").get<double>(),
               stage.at("cpu_seconds").get<double>(), stage.at("device").get<std::string>());
}

ExitCode run(const ReportOptions& options, const Invocation& invocation) {
  report::ReportInputs inputs;
  if (!options.folder.empty()) inputs = report::find_inputs(options.folder);
  append(inputs, inputs.metrics, options.metrics);
  append(inputs, inputs.labels, options.labels);
  append(inputs, inputs.calibrations, options.calibration);
  append(inputs, inputs.recordings, options.recording);
  append(inputs, inputs.figures, options.figures);
  const nlohmann::json data = report::report_data(inputs);
  if (data.at("artefacts").empty() && data.at("figures").empty())
    throw usage_error("no artefacts to report on",
                      "give --folder DIR, or files with --metrics, --labels, ...");
  const std::string page = report::render(data);
  write_file(options.output, page, invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", nlohmann::json{{"output", options.output},
                                      {"bytes", page.size()},
                                      {"stages", data.at("stages")}}
                           .dump(2));
  else {
    print_stages(data.at("stages"));
    fmt::print("{}: {:.1f} MB\n", options.output, 1e-6 * static_cast<double>(page.size()));
  }
  return ExitCode::done;
}

}  // namespace

Command report_command() {
  return make_command<ReportOptions>(
      "report", "write results, trajectories, labels and provenance to one HTML file",
      {"touchtrace report --folder out/demo --output out/demo/report.html",
       "touchtrace report --metrics metrics.json --labels wave.labels.h5 --output wave.html"},
      run, {.overwrite = true});
}

}  // namespace touchtrace::cli
