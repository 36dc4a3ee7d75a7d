// The whole chain at a small size, command by command, as scripts/demo runs it.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;

nlohmann::json read_json(const std::string& path) {
  return nlohmann::json::parse(std::ifstream(path));
}

class WholeChain : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = touchtrace::testing::scratch_folder();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!HasFailure()) fs::remove_all(folder_);
  }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void run(const std::string& arguments) {
    const auto result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << arguments << "\n" << result.output;
  }

  void make_labels() {
    run(std::string("simulate --activity ") + GetParam() + " --minutes 1.2 --seed 5 " +
        at("scene.h5"));
    run("check " + at("scene.h5"));
    run("calibrate " + at("scene.h5") + " --output " + at("calibration"));
    run("label " + at("scene.h5") + " --calibration " + at("calibration") + " --output " +
        at("labels.h5"));
    run("check " + at("labels.h5"));
  }

  void make_models() {
    const std::string data =
        " --recording " + at("scene.h5") + " --labels " + at("labels.h5") + " --updates 40";
    run("train" + data + " --output " + at("full.safetensors"));
    run("train" + data + " --without-touch --output " + at("without_touch.safetensors"));
    run("evaluate --recording " + at("scene.h5") + " --labels " + at("labels.h5") + " --model " +
        at("full.safetensors") + " --model " + at("without_touch.safetensors") + " --output " +
        at("scene.metrics.json"));
    run("report --folder " + folder_.string() + " --output " + at("report.html"));
  }

  /// The example for Python users gets the same numbers from the files alone.
  void expect_same_from_python(const std::string& model) {
    run("evaluate --against labels --recording " + at("scene.h5") + " --labels " + at("labels.h5") +
        " --model " + at(model + ".safetensors") + " --output " + at("python.json"));
    const std::string command = fmt::format(
        "/usr/bin/python3 {}/scripts/evaluate_model.py {} {} {} > {}", TOUCHTRACE_SOURCE_DIR,
        at(model + ".safetensors"), at("scene.h5"), at("labels.h5"), at("python.out"));
    ASSERT_EQ(std::system(command.c_str()), 0);
    const auto python = read_json(at("python.out"));
    const auto evaluated = read_json(at("python.json"));
    for (const auto& row : evaluated.at("results"))
      for (const char* metric : {"l1_at_20", "l1_at_50", "hausdorff"})
        if (row.at("model") == model) {
          // float roll-outs against double ones
          EXPECT_NEAR(python.at(metric).get<double>() / row.at(metric).get<double>(), 1.0, 1e-5)
              << metric;
        }
    fs::remove(at("python.json"));
  }

  /// Predictions from labels and from a prior cover every clip; a prior has a wider band.
  void expect_predictions() {
    const std::string command =
        "predict --recording " + at("scene.h5") + " --model " + at("full.safetensors");
    const auto rows_of = [&](const std::string& options) {
      run(command + options + " --output " + at("predicted.jsonl"));
      std::vector<nlohmann::json> rows;
      std::ifstream file(at("predicted.jsonl"));
      for (std::string line; std::getline(file, line);) rows.push_back(nlohmann::json::parse(line));
      fs::remove(at("predicted.jsonl"));
      return rows;
    };
    const auto prior = rows_of(""), labelled = rows_of(" --labels " + at("labels.h5"));
    ASSERT_FALSE(prior.empty());
    ASSERT_EQ(prior.size(), labelled.size());
    EXPECT_EQ(prior[0].at("start"), "prior");
    EXPECT_EQ(labelled[0].at("start"), "label");
    const auto width = [](const nlohmann::json& row) {
      const auto& body = row.at("object");
      return body.at("position_m_high")[0].get<double>() -
             body.at("position_m_low")[0].get<double>();
    };
    EXPECT_GT(width(prior[0]), width(labelled[0]));
    for (const auto& row : rows_of(" --labels " + at("labels.h5") + " --restart-steps 10")) {
      EXPECT_EQ(row.at("start"), "label");
      EXPECT_GT(width(row), 0.0);
    }
  }

  fs::path folder_;
};

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Corners of the simulated board are found to about 0.05 px.
void expect_good_calibration(const nlohmann::json& calibration) {
  EXPECT_LT(calibration.at("rms_px").get<double>(), 0.1);
  EXPECT_GT(calibration.at("rms_px").get<double>(), 0.0);
}

/// Labels are on the object: errors per axis are smaller than its radius, of the ball or of the
/// racket's blade.
void expect_good_labels(const nlohmann::json& errors, double radius_m) {
  ASSERT_FALSE(errors.empty());
  for (const auto& error : errors) {
    const auto& object = error.at("error").at("object");
    for (const double rms_m : object.at("position_rms_m")) EXPECT_LT(rms_m, radius_m) << error;
    EXPECT_LT(object.at("wrong_share").get<double>(), 0.05) << error;
  }
}

void expect_possible(const nlohmann::json& row) {
  for (const char* key : {"l1_at_20", "l1_at_50", "hausdorff"}) {
    EXPECT_TRUE(std::isfinite(row.at(key).get<double>())) << row;
    EXPECT_GT(row.at(key).get<double>(), 0.0) << row;
  }
  if (row.at("runs") == 0) return;
  EXPECT_GT(row.at("coverage_raw").get<double>(), 0.0) << row;
  EXPECT_LE(row.at("coverage_raw").get<double>(), 1.0) << row;
}

TEST_P(WholeChain, EndsInMetricsAndAReport) {
  make_labels();
  make_models();
  if (HasFatalFailure()) return;
  expect_good_calibration(read_json(at("calibration/calibration.json")));
  const auto metrics = read_json(at("scene.metrics.json"));
  const bool racket = GetParam() == std::string("pingpong");
  expect_good_labels(metrics.at("label_errors"), racket ? 0.0755 : 0.0286);
  const auto report = text_of(at("report.html"));
  std::map<std::string, double> l1_at_20;
  for (const auto& row : metrics.at("results")) {
    l1_at_20[row.at("model")] = row.at("l1_at_20");
    EXPECT_EQ(row.at("activity"), GetParam());
    EXPECT_EQ(row.at("object"), racket ? "racket" : "ball");
    expect_possible(row);
    const auto shown = fmt::format("\"l1_at_20\":{:.5g}", row.at("l1_at_20").get<double>());
    EXPECT_NE(report.find(shown), std::string::npos) << shown << " is not in the report";
  }
  for (const char* model : {"full", "without_touch"}) expect_same_from_python(model);
  expect_predictions();
  // Even 40 updates learn more than a path of another time knows.
  ASSERT_EQ(l1_at_20.size(), 8u) << "five baselines, two models and a control";
  EXPECT_LT(l1_at_20.at("full"), l1_at_20.at("random"));
  EXPECT_LT(l1_at_20.at("without_touch"), l1_at_20.at("random"));
}

INSTANTIATE_TEST_SUITE_P(Activities, WholeChain, ::testing::Values("wave", "throw", "pingpong"),
                         [](const auto& instance) {
                           return std::string(instance.param) + "Scene";
                         });

}  // namespace
