// Runs the scripts of the report in a headless Chromium and checks the resulting DOM. Skipped where
// Chromium is not installed (Debian: apt-get install chromium).
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "engine/base/files.h"
#include "pipeline/report/report.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/browser.h"
#include "tests/verify/support/figure.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::find_browser;
using testing::load;
using testing::LoadedPage;
using testing::TemporaryFolder;

constexpr int num_steps = 5;

json states(double offset) {
  json rows = json::array();
  for (int step = 0; step < num_steps; ++step)
    rows.push_back(json(std::vector<double>(12, offset + 0.01 * step)));
  return rows;
}

json example(const std::string& rank, double l1_at_50) {
  const json spread = std::vector<std::vector<double>>(num_steps, std::vector<double>(12, 0.02));
  return {{"activity", "wave"},
          {"object", "ball"},
          {"recording", "wave.h5"},
          {"clip", 1},
          {"start_s", 2.5},
          {"rank", rank},
          {"l1_at_50", l1_at_50},
          {"rate_hz", 15.0},
          {"target", states(0.0)},
          {"models",
           {{"full", {{"state", states(0.1)}, {"spread", spread}}},
            {"without_touch", {{"state", states(0.2)}, {"spread", spread}}}}},
          // Two frames of 1 x 3 taxels: 0, 128, 255 and 255, 0, 0.
          {"tactile", {{"rows", 1}, {"cols", 3}, {"first_step", -1}, {"data", "AID//wAA"}}}};
}

json result(const std::string& model, double l1_at_50, double coverage_raw, double coverage) {
  json row{{"activity", "wave"},
           {"object", "<b>ball"},
           {"split", "seen"},
           {"model", model},
           {"kind", model},
           {"runs", model == "random" ? 0 : 3},
           {"clips", 24},
           {"rollouts", 120},
           {"l1_at_20", 0.25},
           {"l1_at_50", l1_at_50},
           {"hausdorff", 1.5},
           {"object_error_m_at_50", 0.125},
           {"hand_error_m_at_50", 0.0625},
           {"coverage_raw", nullptr},
           {"coverage", nullptr}};
  if (model != "random") row["coverage_raw"] = coverage_raw, row["coverage"] = coverage;
  const json same = row;
  row["against_labels"] = row["against_unshifted_truth"] = same;
  return row;
}

json model(const std::string& name) {
  return {{"model", name},
          {"path", name + ".safetensors"},
          {"activity", "wave"},
          {"log",
           {{{"seconds", 1.0}, {"validation_l1_at_20", 0.9}},
            {{"seconds", 2.0}, {"validation_l1_at_20", 0.5}}}},
          {"provenance",
           {{"command", "train"},
            {"wall_seconds", 12.5},
            {"cpu_seconds", 25.0},
            {"device", "test device"}}}};
}

json metrics_document() {
  const json body_error{{"bias_m", {0.001, 0.002, -0.003}},
                        {"position_spread_m", {0.004, 0.005, 0.006}},
                        {"velocity_rms_m_per_s", 0.075},
                        {"lost_share", 0.015},
                        {"wrong_share", 0.0025},
                        {"position_coverage", 0.77}};
  json curves = json::array();
  for (const char* name : {"full", "without_touch"})
    curves.push_back({{"activity", "wave"},
                      {"object", "<b>ball"},
                      {"split", "seen"},
                      {"model", name},
                      {"kind", name},
                      {"l1_by_step", {0.1, 0.2, 0.3}},
                      {"nominal_coverage", 0.8},
                      {"coverage_by_step", {0.8, 0.79, 0.78}},
                      {"coverage_raw_by_step", {0.6, 0.59, 0.58}}});
  return {{"schema", "touchtrace/metrics/2"},
          {"against", "truth"},
          {"results",
           {result("random", 0.875, 0, 0), result("without_touch", 0.625, 0.55, 0.75),
            result("full", 0.375, 0.61, 0.79)}},
          {"runs",
           {{{"activity", "wave"},
             {"object", "<b>ball"},
             {"split", "seen"},
             {"model", "full"},
             {"kind", "full"},
             {"file", "full.1.safetensors"},
             {"seed", 1},
             {"l1_at_50", 0.3751}}}},
          {"notes", {"all clips are <b>evaluated"}},
          {"differences",
           {{{"activity", "wave"},
             {"object", "<b>ball"},
             {"split", "seen"},
             {"model", "full"},
             {"kind", "full"},
             {"other", "without_touch"},
             {"metrics",
              {{"l1_at_50", {{"mean", -0.25}, {"low", -0.375}, {"high", -0.125}}},
               {"hausdorff", {{"mean", 0.01}, {"low", -0.5}, {"high", 0.5}}}}}}}},
          {"curves", curves},
          {"examples", {example("median", 0.375), example("best", 0.1875)}},
          {"label_errors",
           {{{"recording", "wave.h5"}, {"error", {{"object", body_error}, {"hand", body_error}}}}}},
          {"models", {model("full"), model("without_touch")}},
          {"provenance", {{"command", "evaluate"}, {"wall_seconds", 1.5}, {"cpu_seconds", 2.5}}}};
}

json calibration_document() {
  return {{"color", {{"width", 640}, {"height", 480}}},
          {"rms_px", 0.234},
          {"depth_rms_m", 0.0015},
          {"details",
           {{"verdict", "GOOD"},
            {"advice", json::array()},
            {"sigmas", {{"color.fx", 0.75}}},
            {"projection_sigma_px", {{0.11, 0.22}, {nullptr, 0.33}}},
            {"coverage", 0.9},
            {"views",
             {{{"name", "view 0"},
               {"rms_px", 0.2},
               {"used", true},
               {"corners_px", {{10, 20}, {30, 40}}},
               {"residuals_px", {{0.1, 0.2}, {0.3, 0.4}}}}}}}}};
}

/// Report with all sections, written to `folder`.
std::string write_inputs_and_render(const TemporaryFolder& folder) {
  std::filesystem::create_directory(folder / "camera");
  testing::put(folder / "metrics.json", metrics_document().dump());
  testing::put(folder / "camera/calibration.json", calibration_document().dump());
  Figure figure = at_most("error of <smoothing>", 0.125, "mm", 0.25);
  figure.picture = Picture{"s", "mm", true, false, {{"default", {0.1, 1.0}, {0.5, 0.25}}}};
  testing::put(folder / "calib.figures.json",
               to_json({figure, at_least("speed", 1.5, "x", 2.0)}).dump());
  const auto sample = testing::sample_recording();
  testing::write(sample, folder / "wave.h5");
  Labels labels = testing::sample_labels(sample.recording);
  for (double& value : labels.raw.object_m) value = 0.5;
  write_labels(folder / "wave.labels.h5", labels, false);
  return report::render(report::report_data(report::find_inputs(folder.path())));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// The element of the section `id`, empty if the page has none.
std::string section(const std::string& dom, const std::string& id) {
  const auto at = dom.find("<section id=\"" + id + "\">");
  return at == std::string::npos ? "" : dom.substr(at, dom.find("</section>", at) - at);
}

bool contains_all(const std::string& text, const std::vector<std::string>& parts) {
  bool all = true;
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos) {
      ADD_FAILURE() << "missing: " << part;
      all = false;
    }
  return all;
}

class ReportInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (find_browser().empty()) GTEST_SKIP() << "no Chromium; the report's scripts are not run";
  }
  TemporaryFolder folder_;
};

TEST_F(ReportInBrowser, DrawsAllSections) {
  const LoadedPage page = load(folder_, write_inputs_and_render(folder_));
  EXPECT_EQ(count(page.console, "CONSOLE"), 0u) << page.console;
  EXPECT_EQ(count(page.dom, "<p class=\"error\">"), 0u);
  EXPECT_EQ(count(page.dom, "NaN"), 0u) << "numbers of charts";

  const std::string results = section(page.dom, "results");
  EXPECT_TRUE(contains_all(
      results,
      {"&lt;b&gt;ball", "w/o Touch", ">0.875<", ">0.625<", ">0.375<", "coverage, as predicted",
       ">0.61<", "coverage, rescaled", ">0.79<", "ideal 0.80", ">120<", ">24<",
       "best\">-0.250 (-0.375 … -0.125)<", "number\">0.01 (-0.50 … 0.50)<", "full.1.safetensors",
       "all clips are &lt;b&gt;evaluated", "Simulated recordings"}));
  EXPECT_EQ(count(results, "<table>"), 5u);
  EXPECT_EQ(count(results, "<tr"), 4u + 2u + 2u + 4u + 4u);
  EXPECT_EQ(count(results, "class=\"number best\">0.375<"), 3u);

  const std::string rollouts = section(page.dom, "roll-outs");
  EXPECT_EQ(count(rollouts, "<canvas class=\"paths\""), 2u);
  EXPECT_EQ(count(rollouts, "<canvas class=\"tactile\" width=\"3\" height=\"1\""), 1u);
  EXPECT_EQ(count(rollouts, "<svg"), 6u);
  EXPECT_EQ(count(rollouts, "<option"), 2u);
  EXPECT_TRUE(contains_all(rollouts, {"median roll-out: L1@50 0.375", "0.00 s"}));

  EXPECT_EQ(count(section(page.dom, "horizon"), "<svg"), 2u);
  EXPECT_TRUE(
      contains_all(section(page.dom, "run-time"),
                   {"<svg", "full.safetensors", ">12.5<", ">25.0<", "test device", "CPU seconds"}));
  EXPECT_TRUE(contains_all(
      section(page.dom, "label-errors"),
      {"wave.h5", ">1.0<", ">-3.0<", ">6.0<", ">0.075<", ">1.50<", ">0.25<", ">0.77<"}));
  const std::string smoothing = section(page.dom, "smoothing");
  EXPECT_EQ(count(smoothing, "<svg"), 6u + 2u) << "positions and error budgets";
  EXPECT_EQ(count(smoothing, "<img src=\"data:image/jpeg;base64,/9j/2Q==\""), 1u);
  EXPECT_GT(count(smoothing, "<circle"), 3u * 20u) << "measured positions";
  EXPECT_TRUE(
      contains_all(section(page.dom, "calibration"),
                   {"0.234 px", "1.50 mm", "GOOD", ">0.11<", ">0.33<", "90 %", "color.fx"}));
  EXPECT_TRUE(contains_all(section(page.dom, "figures"), {"error of &lt;smoothing&gt;", ">0.1250<",
                                                          "PASS", "FAIL", "log10 of s", "<svg"}));
  EXPECT_TRUE(contains_all(section(page.dom, "provenance"), {"wave.labels.h5", "metrics.json"}));
}

TEST_F(ReportInBrowser, ChartsTheErrorOverAnOption) {
  json metrics = metrics_document();
  metrics["results"] = {result("without_touch", 0.625, 0, 0)};
  for (const int resolution : {32, 8, 16}) {
    json row = result("full", 8.0 / resolution, 0, 0);
    row["options"] = {{"resolution", resolution}, {"data", "ab+cd"}};
    row["intervals"] = {{"l1_at_50", {7.0 / resolution, 9.0 / resolution}}};
    metrics["results"].push_back(row);
  }
  testing::put(folder_ / "metrics.json", metrics.dump());
  const LoadedPage page =
      load(folder_, report::render(report::report_data(report::find_inputs(folder_.path()))));
  EXPECT_EQ(count(page.console, "CONSOLE"), 0u) << page.console;
  const std::string options = section(page.dom, "options");
  EXPECT_EQ(count(options, "<figure"), 1u);
  EXPECT_TRUE(contains_all(options, {"L1@50, wave · &lt;b&gt;ball", ">resolution<", "w/o Touch"}));
  EXPECT_EQ(count(options, "NaN"), 0u);
  EXPECT_EQ(count(options, "fill-opacity"), 1u) << "band of the intervals";
}

TEST_F(ReportInBrowser, ChartsTheErrorOverTrainingTime) {
  json metrics = metrics_document();
  metrics["results"] = json::array(), metrics["runs"] = json::array();
  // Of these, "slow" takes longer than "best" and errs more.
  const std::vector<std::tuple<std::string, double, double>> models{
      {"full x=fast", 0.5, 10}, {"full x=best", 0.25, 20}, {"full x=slow", 0.375, 40}};
  for (const auto& [name, error, seconds] : models) {
    json row = result("full", error, 0, 0);
    row["model"] = name;
    metrics["results"].push_back(row);
    for (const double deviation : {-1.0, 1.0})
      metrics["runs"].push_back({{"activity", row["activity"]},
                                 {"object", row["object"]},
                                 {"split", row["split"]},
                                 {"model", name},
                                 {"kind", "full"},
                                 {"file", "x"},
                                 {"seed", 1},
                                 {"training_cpu_seconds", seconds + deviation}});
  }
  testing::put(folder_ / "metrics.json", metrics.dump());
  const LoadedPage page =
      load(folder_, report::render(report::report_data(report::find_inputs(folder_.path()))));
  EXPECT_EQ(count(page.console, "CONSOLE"), 0u) << page.console;
  const std::string options = section(page.dom, "options");
  EXPECT_TRUE(contains_all(options, {"x=fast", "x=best", "x=slow", "CPU seconds"}));
  EXPECT_EQ(count(options, "<circle"), 3u);
  const std::size_t front = options.find("<path d=\"") + 9;
  EXPECT_EQ(count(options.substr(front, options.find('"', front) - front), "L"), 1u)
      << "fast, best";
}

TEST_F(ReportInBrowser, ReactsToChooserAndSliderAndPaintsCanvases) {
  const LoadedPage page = load(folder_, write_inputs_and_render(folder_), R"(
    const choice = document.querySelector("select");
    choice.value = 1;
    choice.dispatchEvent(new Event("change"));
    const slider = document.querySelector("input[type=range]");
    slider.value = 0;
    slider.dispatchEvent(new Event("input"));
    const pixels = (canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const painted = [...document.querySelectorAll("canvas.paths")].map((canvas) => pixels(canvas).some((v) => v > 0));
    const levels = [...pixels(document.querySelector("canvas.tactile"))].filter((_, i) => i % 4 === 0);
    document.body.append(`painted ${painted} levels ${levels} at ${slider.nextSibling.textContent};`);)");
  EXPECT_EQ(count(page.console, "CONSOLE"), 0u) << page.console;
  // Red channel of the colour map at 0, 128/255 and 1.
  EXPECT_TRUE(contains_all(page.dom, {"painted true,true levels 24,", ",252 at -0.07 s;"}));
}

TEST_F(ReportInBrowser, ReportsASectionThatFailsAndDrawsTheOthers) {
  json data = json::parse(
      R"({"title": "t", "version": "1", "created": "now", "calibrations": [], "figures": [],
    "smoothing": [{"name": "broken"}], "stages": [], "artefacts": [{"artefact": "a.h5", "provenance": {}}]})");
  data["metrics"] = nullptr;
  const LoadedPage page = load(folder_, report::render(data));
  EXPECT_EQ(count(page.dom, "<p class=\"error\">A section of this report could not be drawn: "),
            1u);
  EXPECT_NE(section(page.dom, "provenance"), "");
  EXPECT_EQ(section(page.dom, "results"), "");
}

}  // namespace
}  // namespace touchtrace
