// Ctrl-C during a command: exit code 130, and no new file.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/end_to_end/running_program.h"
#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;
using touchtrace::testing::RunningProgram;

class Interrupt : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    fs::remove_all(folder_);
    fs::remove(log_);
  }

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
  /// Interrupts a command as soon as `has_begun(program)`.
  template <class Event>
  void expect_clean_interrupt(const std::string& arguments, Event has_begun) {
    SCOPED_TRACE(arguments);
    const auto before = names();
    RunningProgram program(arguments, log_);
    ASSERT_TRUE(program.wait_for([&] { return has_begun(program); })) << output();
    program.signal(SIGINT);
    EXPECT_EQ(program.wait(), 130) << output();
    EXPECT_EQ(names(), before);
  }
  std::string output() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
  fs::path log_ = folder_.string() + ".log";
};

TEST_F(Interrupt, LeavesNoPartialFiles) {
  const auto writes = [&](const RunningProgram&) { return !names().empty(); };
  expect_clean_interrupt("simulate --minutes 60 " + at("long.h5"), writes);

  run("simulate --activity wave --object ball --minutes 0.6 --seed 5 " + at("scene.h5"));
  const auto reads = [&](const RunningProgram& program) {
    return program.has_open(at("scene.h5"));
  };
  expect_clean_interrupt("calibrate " + at("scene.h5") + " --output " + at("partial"), reads);
  run("calibrate " + at("scene.h5") + " --output " + at("calibration"));
  const auto label = "label " + at("scene.h5") + " --calibration " + at("calibration") + " -o ";
  expect_clean_interrupt(label + at("partial.h5"), reads);
  run(label + at("labels.h5"));
}

}  // namespace
