// The whole chain at a small size, verb by verb, as scripts/demo runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;

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

  fs::path folder_;
};

void expect_finite_row(const nlohmann::json& row) {
  for (const char* key : {"l1_at_20", "l1_at_50", "hausdorff"}) {
    EXPECT_TRUE(std::isfinite(row.at(key).get<double>())) << row;
    EXPECT_GT(row.at(key).get<double>(), 0.0) << row;
  }
}

TEST_P(WholeChain, EndsInMetricsAndAReport) {
  make_labels();
  make_models();
  if (HasFatalFailure()) return;
  const auto results = nlohmann::json::parse(std::ifstream(at("scene.metrics.json"))).at("results");
  std::vector<std::string> models;
  for (const auto& row : results) {
    models.push_back(row.at("model"));
    EXPECT_EQ(row.at("activity"), GetParam());
    EXPECT_EQ(row.at("object"), GetParam() == std::string("pingpong") ? "racket" : "ball");
    expect_finite_row(row);
  }
  for (const char* model : {"random", "without_touch", "full"})
    EXPECT_NE(std::ranges::find(models, model), models.end()) << model;
  EXPECT_GT(fs::file_size(at("report.html")), 10000u);
}

INSTANTIATE_TEST_SUITE_P(Activities, WholeChain, ::testing::Values("wave", "throw", "pingpong"),
                         [](const auto& instance) {
                           return std::string(instance.param) + "Scene";
                         });

}  // namespace
