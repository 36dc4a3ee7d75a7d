// Ctrl-C in the midst of a verb: exit code 130, and no file that was not there before.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;

class Interrupt : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      found.insert(entry.path().filename());
    return found;
  }
  void run(const std::string& arguments) {
    const auto result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  void expect_interrupted(const std::string& arguments, double after_s) {
    const auto before = names();
    // Without --foreground the program would get the signal twice, and the second kills it at once.
    const auto result = run_program(arguments, "timeout --foreground --preserve-status -s INT " +
                                                   std::to_string(after_s) + " ");
    EXPECT_EQ(result.exit_code, 130) << arguments << "\n" << result.output;
    EXPECT_EQ(names(), before) << arguments;
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(Interrupt, LeavesNothingHalfWritten) {
  expect_interrupted("simulate --minutes 60 " + at("long.h5"), 2.0);
  run("simulate --activity wave --object ball --minutes 0.6 --seed 5 " + at("scene.h5"));
  expect_interrupted("calibrate " + at("scene.h5") + " --output " + at("cut_short"), 0.5);
  run("calibrate " + at("scene.h5") + " --output " + at("calibration"));
  const auto label = "label " + at("scene.h5") + " --calibration " + at("calibration") + " -o ";
  expect_interrupted(label + at("cut_short.h5"), 1.0);
  run(label + at("labels.h5"));
}

}  // namespace
