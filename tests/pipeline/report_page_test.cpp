// Data and structure of the report; report_page_browser_test.cpp runs its scripts.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/report/page.h"
#include "pipeline/report/report.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/verify/support/figure.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ReportPage : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    write_file(folder_ / name, text, true);
    return folder_ / name;
  }

  testing::TemporaryFolder folder_;
};

json metrics_document(const std::string& activity) {
  return {{"schema", "touchtrace/metrics/2"},
          {"against", "truth"},
          {"results",
           {{{"activity", activity},
             {"object", "</script><b>ball"},
             {"split", "seen"},
             {"model", "full"},
             {"kind", "full"},
             {"l1_at_20", 0.123456789}}}},
          {"runs", json::array()},
          {"notes", json::array()},
          {"differences", json::array()},
          {"curves", json::array()},
          {"examples", json::array()},
          {"label_errors", json::array()},
          {"models",
           {{{"model", "full"},
             {"path", "out/full.safetensors"},
             {"activity", activity},
             {"log", json::array()},
             {"provenance", {{"verb", "train"}, {"wall_seconds", 12.0}}}}}},
          {"provenance", {{"command", "evaluate"}, {"wall_seconds", 1.5}}}};
}

TEST_F(ReportPage, IsSelfContained) {
  const auto path = write("wave.metrics.json", metrics_document("wave").dump());
  report::ReportInputs inputs;
  inputs.metrics = {path};
  const std::string page = report::render(report::report_data(inputs));
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  for (const char* token : {"@DATA@", "@STYLE@", "@SCRIPT@", "</script><b>"})
    EXPECT_EQ(page.find(token), std::string::npos) << token;
  // A namespace, which is not fetched, and references within the page.
  const std::regex harmless(R"(http://www\.w3\.org/2000/svg|url\(#)");
  const std::string addresses = std::regex_replace(page, harmless, "");
  for (const char* token :
       {"http:", "https:", "src=", "@import", "url(", "fetch(", "XMLHttpRequest"})
    EXPECT_EQ(addresses.find(token), std::string::npos) << token;
}

TEST_F(ReportPage, ScriptsCreateTextNodesOnly) {
  const std::string page = report::render(json::object());
  for (const char* token :
       {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("})
    EXPECT_EQ(page.find(token), std::string::npos) << token;
}

TEST_F(ReportPage, EmbedsAllScriptsAndUsesAllFunctions) {
  const std::string page = report::render(json::object());
  for (const auto& [name, text] : report_page())
    if (name.ends_with(".js") || name.ends_with(".css")) {
      EXPECT_NE(page.find(text), std::string::npos) << name;
    }
  std::map<std::string, int> uses;  // of each word
  std::vector<std::string> functions;
  const std::regex word(R"(\w+)");
  std::string previous;
  for (std::sregex_iterator at(page.begin(), page.end(), word), end; at != end; ++at) {
    ++uses[at->str()];
    if (previous == "function") functions.push_back(at->str());
    previous = at->str();
  }
  for (const std::string& function : functions)
    EXPECT_GE(uses[function], 2) << function << " is never called";
  EXPECT_GE(functions.size(), 30u);
}

TEST_F(ReportPage, RoundsNumbersAndListsStages) {
  report::ReportInputs inputs;
  inputs.metrics = {write("wave.metrics.json", metrics_document("wave").dump())};
  const json data = report::report_data(inputs);
  EXPECT_DOUBLE_EQ(data.at("metrics").at("results")[0].at("l1_at_20"), 0.12346);
  ASSERT_EQ(data.at("stages").size(), 2u);
  EXPECT_EQ(data.at("stages")[0].at("artefact"), "full.safetensors");
  EXPECT_EQ(data.at("stages")[0].at("wall_seconds"), 12.0);
}

TEST_F(ReportPage, LeavesOutFilesOfAFolderThatCannotBeRead) {
  for (const char* name : {"glove.h5", "a.labels.h5", "bad.metrics.json", "bad.figures.json"})
    write(name, "of another program");
  write("calibration.json", "{}");
  const auto inputs = report::find_inputs(folder_.path());
  EXPECT_EQ(inputs.found.size(), 5u);
  const json data = report::report_data(inputs);
  for (const char* key : {"calibrations", "smoothing", "figures", "artefacts"})
    EXPECT_TRUE(data.at(key).empty()) << key;
  EXPECT_TRUE(data.at("metrics").is_null());
}

TEST_F(ReportPage, SeparatesDataSetsOfOneActivity) {
  const auto document_of = [&](const char* recording) {
    json document = metrics_document("wave");
    document["provenance"]["options"]["recording"] = {recording};
    return document.dump();
  };
  const auto names = [&] {
    std::vector<std::string> found;
    const json data = report::report_data(report::find_inputs(folder_.path()));
    for (const json& row : data.at("metrics").at("results"))
      found.push_back(row.value("data_set", ""));
    return found;
  };
  write("a.metrics.json", document_of("a.h5"));
  write("b.metrics.json", document_of("a.h5"));
  EXPECT_EQ(names(), (std::vector<std::string>{"", ""}));
  write("b.metrics.json", document_of("b.h5"));
  EXPECT_EQ(names(), (std::vector<std::string>{"a.h5, against truth", "b.h5, against truth"}));
}

TEST_F(ReportPage, CombinesMetricsFiles) {
  write("wave.metrics.json", metrics_document("wave").dump());
  write("throw.metrics.json", metrics_document("throw").dump());
  const json both = report::report_data(report::find_inputs(folder_.path()));
  EXPECT_EQ(both.at("metrics").at("results").size(), 2u);
  write("metrics.json", metrics_document("wave").dump());
  const json whole = report::report_data(report::find_inputs(folder_.path()));
  EXPECT_EQ(whole.at("metrics").at("results").size(), 1u) << "metrics.json replaces the others";
}

TEST_F(ReportPage, IncludesFiguresAndPictures) {
  Figure figure = at_least("engine against a peer", 2.25, "x", 2.0);
  figure.picture = Picture{"s", "error", false, false, {{"engine", {0, 1}, {1.0, 0.123456789}}}};
  write("engine.figures.json", to_json({figure, reported("other", 1, "")}).dump());
  const json data = report::report_data(report::find_inputs(folder_.path()));
  ASSERT_EQ(data.at("figures").size(), 1u);
  const json& rows = data.at("figures")[0].at("figures");
  EXPECT_EQ(data.at("figures")[0].at("name"), "engine.figures.json");
  EXPECT_EQ(rows[0].at("goal"), ">= 2");
  EXPECT_EQ(rows[0].at("picture").at("curves")[0].at("y")[1], 0.12346);
  EXPECT_FALSE(rows[1].contains("picture"));
}

TEST_F(ReportPage, RejectsInvalidFigures) {
  const std::string row = R"({"name":"a","value":1,"unit":"s","goal":"","holds":true)";
  for (
      const std::string& text :
      {std::string("["), std::string("{}"), std::string(R"({"figures":[{"name":"a"}]})"),
       R"({"figures":[)" + row + R"(,"picture":{}}]})",
       R"({"figures":[)" + row +
           R"(,"picture":{"x_label":"","y_label":"","curves":[{"name":"c","x":[1],"y":[]}]}}]})"}) {
    report::ReportInputs inputs;
    inputs.figures = {write("bad.figures.json", text)};
    EXPECT_THROW(report::report_data(inputs), Error) << text;
  }
}

TEST_F(ReportPage, IncludesUncertaintyOfCalibrations) {
  json document{{"color", {{"width", 640}, {"height", 480}}},
                {"rms_px", 0.25},
                {"depth_rms_m", 0.001},
                {"details",
                 {{"verdict", "GOOD"},
                  {"advice", json::array()},
                  {"sigmas", json::object()},
                  {"view_inflation", 3.1},
                  {"projection_sigma_px", {{0.1, 0.123456789}, {nullptr, 0.3}}},
                  {"coverage", 0.9},
                  {"target_deformation", {{"sigma_m", 6e-5}}},
                  {"views", json::array()}}}};
  report::ReportInputs inputs;
  inputs.calibrations = {write("calibration.json", document.dump())};
  const json with = report::report_data(inputs).at("calibrations")[0];
  EXPECT_EQ(with.at("projection_sigma_px"), json({{0.1, 0.12346}, {nullptr, 0.3}}));
  EXPECT_EQ(with.at("coverage"), 0.9);
  EXPECT_EQ(with.at("view_inflation"), 3.1);
  EXPECT_EQ(with.at("deformation_sigma_m"), 6e-5);
  for (const char* key : {"projection_sigma_px", "coverage", "target_deformation"})
    document["details"].erase(key);
  inputs.calibrations = {write("calibration.json", document.dump())};
  const json older = report::report_data(inputs).at("calibrations")[0];
  EXPECT_TRUE(older.at("projection_sigma_px").empty());
  EXPECT_EQ(older.at("deformation_sigma_m"), 0.0);
  document["details"]["board_print"]["sigma_m"] = 7e-5;  // key of older versions
  inputs.calibrations = {write("calibration.json", document.dump())};
  EXPECT_EQ(report::report_data(inputs).at("calibrations")[0].at("deformation_sigma_m"), 7e-5);
  document["details"] = {{"verdict", "IMPORTED"}};
  inputs.calibrations = {write("calibration.json", document.dump())};
  const json imported = report::report_data(inputs).at("calibrations")[0];
  EXPECT_EQ(imported.at("verdict"), "IMPORTED");
  EXPECT_TRUE(imported.at("views").empty());
  EXPECT_EQ(imported.at("name"), folder_.path().filename().string());
  inputs.calibrations = {write("calibration.json", "{}")};
  EXPECT_THROW(report::report_data(inputs), Error);
}

TEST_F(ReportPage, IncludesContactSheetAndErrorBudget) {
  Labels labels = testing::sample_labels(testing::sample_recording().recording);
  report::ReportInputs inputs;
  inputs.labels = {folder_ / "wave.labels.h5"};
  write_labels(inputs.labels[0], labels, false);
  const json with = report::report_data(inputs).at("smoothing")[0];
  EXPECT_EQ(with.at("contact_sheet"), "data:image/jpeg;base64,/9j/2Q==");
  EXPECT_EQ(with.at("error_sources").size(), 5u);
  EXPECT_EQ(with.at("hand_budget").size(), with.at("time_s").size());
  EXPECT_NEAR(with.at("object_budget")[1][2], labels.object.error_budget_m[7], 1e-4);
  labels.contact_sheet_jpeg.clear();
  labels.summary = json::array();
  write_labels(inputs.labels[0], labels, true);
  const json without = report::report_data(inputs).at("smoothing")[0];
  EXPECT_EQ(without.at("contact_sheet"), "");
  EXPECT_TRUE(without.at("object_budget").empty());
}

TEST_F(ReportPage, OmitsMissingInputs) {
  const json data = report::report_data({});
  EXPECT_TRUE(data.at("metrics").is_null());
  for (const char* key : {"calibrations", "smoothing", "figures", "stages", "artefacts"})
    EXPECT_TRUE(data.at(key).empty()) << key;
  EXPECT_TRUE(report::find_inputs(folder_.path()).found.empty());
}

TEST_F(ReportPage, RejectsInvalidMetrics) {
  for (const char* text :
       {"", "{", "[]", "null", "{\"schema\":\"other\"}", "{\"schema\":\"touchtrace/metrics/1\"}"}) {
    report::ReportInputs inputs;
    inputs.metrics = {write("bad.metrics.json", text)};
    EXPECT_THROW(report::report_data(inputs), Error) << text;
  }
  EXPECT_THROW(report::find_inputs(folder_ / "none"), Error);
}

}  // namespace
}  // namespace touchtrace
