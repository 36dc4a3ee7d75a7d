#include "tests/verify/areas.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "pipeline/report/report.h"
#include "tests/verify/verifications.h"

namespace touchtrace::verify {
namespace {

struct AreaOptions {
  std::string report;
};

void describe(OptionSet& set, AreaOptions& o) {
  set.text("report", o.report, "HTML page of the figures and their plots").value("FILE");
}

void print_row(const Figure& figure) {
  fmt::print("{:<52} {:>12.6g} {:<10} {:<16} {:<4} {:8.2f} s\n", figure.name, figure.value,
             figure.unit, figure.goal_text(), figure.passes() ? "PASS" : "FAIL", figure.seconds);
  std::fflush(stdout);  // a reader of a pipe sees each row as soon as it is measured
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

std::string figures_page(const std::string& area, const std::vector<Figure>& figures) {
  auto data = report::report_data({});
  data["title"] = "touchtrace-verify " + area;
  data["figures"].push_back({{"name", area}, {"figures", to_json(figures).at("figures")}});
  return report::render(data);
}

ExitCode run(const std::string& area, const Verification& verification, const AreaOptions& options,
             const cli::Invocation& invocation) {
  const auto figures = measure(verification, !invocation.json);
  if (invocation.json) fmt::print("{}\n", to_json(figures).dump(2));
  if (!options.report.empty())
    write_file(options.report, figures_page(area, figures), invocation.overwrite);
  const bool all_pass = std::ranges::all_of(figures, &Figure::passes);
  return all_pass ? ExitCode::done : ExitCode::data;
}

/// Command that measures one area.
cli::Command area(const std::string& name, const std::string& summary, Verification verification) {
  const auto options = std::make_shared<AreaOptions>();
  return {name,
          summary,
          {"touchtrace-verify " + name + " --report " + name + ".html"},
          [options](OptionSet& set) { describe(set, *options = AreaOptions{}); },
          [=](const cli::Invocation& invocation) {
            return run(name, verification, *options, invocation);
          },
          {.overwrite = true, .quiet = true}};
}

struct SceneAreaOptions : AreaOptions {
  std::string real;
};

/// Area `scene`, or a comparison of simulated gloves with recorded ones.
cli::Command scene_area() {
  const auto options = std::make_shared<SceneAreaOptions>();
  return {
      "scene",
      "physics against closed forms and statistics",
      {"touchtrace-verify scene --report scene.html", "touchtrace-verify scene --real gloves"},
      [options](OptionSet& set) {
        describe(set, *options = SceneAreaOptions{});
        set.text(
               "real", options->real,
               "folder of recordings of gloves: instead, whether simulated gloves are within their "
               "range")
            .value("FOLDER");
      },
      [options](const cli::Invocation& invocation) {
        const auto verification =
            options->real.empty() ? scene::verify_scene() : scene::verify_gloves(options->real);
        return run("scene", verification, *options, invocation);
      },
      {.overwrite = true, .quiet = true}};
}

}  // namespace

const cli::Program& verify_program() {
  static const cli::Program program{
      "touchtrace-verify",
      "touchtrace-verify measures the figures that each module of touchtrace promises. It prints "
      "rows of name, value, unit, goal, PASS or FAIL, and seconds; exit code 3 if a row fails.",
      {{"Areas",
        {area("calibration", "photographs of opencv-doc and simulated boards (3 min)",
              calibration_verification()),
         area("engine", "extremes, speed of training, start of a process (10 min)",
              verify_engine()),
         area("first-step", "the first training step of a process", verify_first_step()),
         area("labels", "smoothing, clocks, labels of rendered scenes (40 min)",
              study::verify_labels()),
         area("record", "live predictions, crashes while recording, damaged files, load (7 min)",
              verify_record()),
         area("record-hours",
              "8 hours of glove and camera, at 10 times their rates (48 min; Ctrl-C: the time "
              "until then)",
              verify_hours()),
         area("recording", "crash safety and damaged files (4 min)", verify_recording()),
         scene_area(),
         area("study", "training and evaluation on a synthetic data set", study::verify_study())}}},
      {}};
  return program;
}

}  // namespace touchtrace::verify
