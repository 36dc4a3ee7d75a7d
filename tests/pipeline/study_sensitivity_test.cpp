#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/scene/simulate/simulate.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/verify/study/sensitivity.h"
#include "tests/verify/study/simulated_labels.h"

namespace touchtrace::study {
namespace {

using testing::TemporaryFolder;

Provenance provenance_of(const SensitivityOptions& options) {
  Provenance provenance = start_provenance("touchtrace/sensitivity/1", "test");
  provenance.options = {{"clips", options.clips}, {"only", options.only}};
  return provenance;
}

SensitivityOptions small(const std::filesystem::path& output) {
  SensitivityOptions options;
  options.output = output.string();
  options.only = {"glove-noise", "throw-apex"};
  options.seeds = 2;
  options.clips = 10;
  options.updates = 3;
  options.resolution = 6;
  options.window = 2;
  return options;
}

nlohmann::json cell_of(const nlohmann::json& document, const nlohmann::json& name, double factor,
                       int seed) {
  for (const auto& cell : document["cells"])
    if (cell["assumption"] == name && cell["factor"] == factor && cell["seed"] == seed) return cell;
  return nullptr;
}

TEST(StudySensitivity, ComparesHalfAndDoubleOnTheSameRandomNumbers) {
  const TemporaryFolder folder;
  Runtime runtime(choose_device(""));
  SensitivityOptions options = small(folder / "wave.json");
  const auto found = measure_sensitivity(runtime, options, provenance_of(options), false);
  ASSERT_EQ(found["cells"].size(), 6u);
  const auto usual = cell_of(found, nullptr, 1.0, 1), half = cell_of(found, "glove-noise", 0.5, 1),
             apex = cell_of(found, "throw-apex", 2.0, 1);
  EXPECT_NE(usual["full"], half["full"]);
  EXPECT_EQ(usual["without_touch"], half["without_touch"]);  // sensor noise does not affect motion
  EXPECT_EQ(usual["full"], apex["full"]);                    // no throws in this activity
  EXPECT_NE(usual["full"], cell_of(found, nullptr, 1.0, 2)["full"]);
  const std::string table = sensitivity_table(found);
  EXPECT_NE(table.find("| glove-noise | 0.75, 3 |"), std::string::npos) << table;
  EXPECT_NE(table.find("Nothing changed with: throw-apex."), std::string::npos) << table;

  options.resume = true;
  options.only = {"glove-noise"};
  EXPECT_EQ(measure_sensitivity(runtime, options, provenance_of(options), false), found);
  options.clips = 20;
  EXPECT_THROW(measure_sensitivity(runtime, options, provenance_of(options), false), Error);
}

TEST(StudySensitivity, RejectsResumingFromOtherFiles) {
  const TemporaryFolder folder;
  Runtime runtime(choose_device(""));
  SensitivityOptions options = small(folder / "wave.json");
  options.resume = true;
  for (const char* text :
       {"", "[]", "3", R"({"cells": 1})", R"({"cells": [1]})", R"({"cells": [{}]})",
        R"({"cells": [{"assumption": null, "factor": "1", "seed": 1}]})",
        R"({"cells": [{"assumption": "arm-mass", "factor": 1, "seed": 1, "value": ["x"]}]})"}) {
    write_file(options.output, text, true);
    try {
      measure_sensitivity(runtime, options, provenance_of(options), false);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data) << text;
    }
  }
  for (const char* provenance : {"1", "[]", "{}", R"({"options": 1})"}) {
    write_file(options.output, fmt::format(R"({{"cells": [], "provenance": {}}})", provenance),
               true);
    EXPECT_THROW(measure_sensitivity(runtime, options, provenance_of(options), false), Error);
  }
}

TEST(StudySensitivity, RenderedLabelsHaveMeasurementErrors) {
  const TemporaryFolder folder;
  Runtime runtime(choose_device(""));
  scene::SceneOptions scene;
  scene.minutes = 0.2;
  simulate_recording(scene, &runtime, folder / "wave.h5", false,
                     start_provenance("touchtrace/recording/2", "test"));
  const Dataset data = load_with_rendered_labels(folder / "wave.h5", 8);
  double square_m2 = 0.0, trusted = 0.0;
  for (int i = 0; i < data.frames(); ++i)
    if (data.trusted[i]) {
      square_m2 += std::pow(data.label[i][0] - data.truth[i][0], 2);
      ++trusted;
    }
  EXPECT_GT(trusted, 0.9 * data.frames());
  EXPECT_GT(trusted, 100.0);
  const double error_m = std::sqrt(square_m2 / trusted);
  EXPECT_LT(error_m, 0.010);
  EXPECT_GT(error_m, 1e-5);  // measured, not copied from the truth
}

TEST(StudySensitivity, ModelledLabelsHaveTheModelledErrors) {
  const TemporaryFolder folder;
  scene::SceneOptions scene;
  scene.minutes = 5.0;
  simulate_recording(scene, nullptr, folder / "wave.h5", false,
                     start_provenance("touchtrace/recording/2", "test"));
  const LabelErrorModel model{
      {{0.004, 0.002, 0.006}, 0.05, 0.10}, {{0.005, 0.005, 0.005}, 0.03, 0.03}, 0.0, 0.2};
  const Dataset data = load_with_modelled_labels(folder / "wave.h5", model, 8, 1);
  std::array<double, state_size> square{}, causal{};
  double lost = 0.0;
  for (int i = 0; i < data.frames(); ++i) {
    lost += data.trusted[i] ? 0.0 : 1.0 / data.frames();
    for (int d = 0; d < state_size; ++d) {
      square[d] += std::pow(data.label[i][d] - data.truth[i][d], 2) / data.frames();
      causal[d] += std::pow(data.causal_label[i][d] - data.truth[i][d], 2) / data.frames();
    }
  }
  // 30 clips of 8 sinusoids: relative standard error of a sigma 1 / sqrt(2 * 240) = 5 %; 2 of these
  const auto near = [](double found, double wanted) { EXPECT_NEAR(found, wanted, 0.1 * wanted); };
  for (int axis = 0; axis < 3; ++axis) {
    near(std::sqrt(square[axis]), model.object.position_m[axis]);
    near(std::sqrt(square[3 + axis]), 0.05);
    near(std::sqrt(causal[3 + axis]), 0.10);
    near(std::sqrt(square[6 + axis]), 0.005);
    near(std::sqrt(square[9 + axis]), 0.03);
  }
  EXPECT_NEAR(lost, 0.2, 0.02);
}

}  // namespace
}  // namespace touchtrace::study
