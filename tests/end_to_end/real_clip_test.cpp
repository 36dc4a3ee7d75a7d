#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::run_program;

const std::string clip = std::string(TOUCHTRACE_SOURCE_DIR) + "/tests/data/hand_pour_bottle";

/// A recorded clip of one frame per second: from a folder of images to labels and their video.
class RealClip : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string file(const char* name) const { return (folder_ / name).string(); }

  /// Runs a command that must succeed.
  std::string run(const std::string& command) const {
    const auto result = run_program(command);
    EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.output;
    return result.output;
  }
  nlohmann::json label(const std::string& options) const {
    const auto output = run("label " + file("clip.h5") + " --output " + file("labels.h5") +
                            " --tracker component --json --quiet " + options);
    EXPECT_NE(output.find("at 1 Hz bodies move far"), std::string::npos) << output;
    return nlohmann::json::parse(output.substr(output.find('{')));
  }

 private:
  std::filesystem::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(RealClip, BoxesGiveLabelsAndAVideo) {
  run("import " + clip + " --depth-scale 1000 --quiet --output " + file("clip.h5"));
  run("mark " + file("clip.h5") + " --box hand=227,103,36,50 --box object=226,81,52,44 --frame 0");
  const auto summary = label("--preview " + file("preview.mp4"));
  EXPECT_EQ(summary["observer"], "depth-color");
  EXPECT_LE(summary["hand_lost_share"], 0.4);
  EXPECT_GT(std::filesystem::file_size(file("preview.mp4")), 10'000u);
}

/// Frames without a mask are lost, not guessed.
TEST_F(RealClip, MasksGiveLabels) {
  run("import " + clip + " --depth-scale 1000 --quiet --masks " + clip + "/masks --output " +
      file("clip.h5"));
  const auto summary = label("");
  EXPECT_EQ(summary["observer"], "masks");
  EXPECT_NEAR(summary["object_lost_share"], 0.4, 0.01);
}

}  // namespace
