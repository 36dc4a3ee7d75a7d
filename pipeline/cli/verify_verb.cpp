#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <map>

#include "engine/base/figure.h"
#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/base/text.h"
#include "engine/train/verify_engine.h"
#include "pipeline/acquire/verify_images.h"
#include "pipeline/cli/verbs.h"
#include "pipeline/cli/verify_processes.h"
#include "pipeline/recording/verify_recording.h"
#include "pipeline/report/figures_page.h"
#include "pipeline/scene/laboratory/verify_scene.h"
#include "pipeline/study/verify_labels.h"
#include "pipeline/study/verify_study.h"

namespace touchtrace::cli {
namespace {

struct VerifyOptions {
  std::string area, report;
};

Verification engine_verification() {
  return [](const std::function<void(Figure)>& emit) {
    verify_processes(emit);
    verify_engine()(emit);
  };
}

/// One row an area: what a room promises, measured by the room itself.
const std::map<std::string, Verification>& areas() {
  static const std::map<std::string, Verification> table{
      {"calibration", calibration_verification()},
      {"engine", engine_verification()},
      {"first-step", verify_first_step()},
      {"labels", study::verify_labels()},
      {"recording", verify_recording()},
      {"scene", scene::verify_scene()},
      {"study", study::verify_study()},
      {"weights", verify_weights()},
  };
  return table;
}

std::vector<std::string> area_names() {
  std::vector<std::string> names;
  for (const auto& [name, verification] : areas()) names.push_back(name);
  return names;
}

void describe(OptionSet& set, VerifyOptions& o) {
  set.input("area", o.area, "what to measure: " + comma_separated(area_names()));
  set.text("report", o.report, "HTML file to write with the figures and their pictures");
}

void print_row(const Figure& figure) {
  fmt::print("{:<52} {:>12.6g} {:<10} {:<16} {:<5} {:8.2f} s\n", figure.name, figure.value,
             figure.unit, figure.goal_text(), figure.holds() ? "holds" : "FALLS SHORT",
             figure.seconds);
  std::fflush(stdout);  // rows are there as soon as they are known, also in a pipe
}

std::vector<Figure> measure(const Verification& verification, bool print) {
  std::vector<Figure> figures;
  auto last = std::chrono::steady_clock::now();
  verification([&](Figure figure) {
    const auto now = std::chrono::steady_clock::now();
    figure.seconds = std::chrono::duration<double>(now - std::exchange(last, now)).count();
    if (print) print_row(figure);
    figures.push_back(std::move(figure));
    throw_if_interrupted();
  });
  return figures;
}

ExitCode run(const VerifyOptions& options, const Invocation& invocation) {
  const auto area = areas().find(options.area);
  if (area == areas().end())
    throw usage_error(fmt::format("there is no area '{}' to verify", options.area),
                      suggestion(options.area, area_names()));
  const auto figures = measure(area->second, !invocation.json);
  if (invocation.json) fmt::print("{}\n", to_json(figures).dump(2));
  if (!options.report.empty())
    write_file(options.report, report::figures_page("touchtrace verify " + options.area, figures),
               invocation.overwrite);
  for (const auto& figure : figures)
    if (!figure.holds()) return ExitCode::data;
  return ExitCode::done;
}

}  // namespace

Verb verify_verb() {
  return make_verb<VerifyOptions>(
      "verify", "measure the figures that a part of touchtrace promises",
      {"touchtrace verify engine", "touchtrace verify labels --json"}, run);
}

}  // namespace touchtrace::cli
