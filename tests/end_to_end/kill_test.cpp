// `touchtrace train` that is killed at random checkpoints or loses its device, and is then resumed:
// the weights must equal those of an uninterrupted run.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/end_to_end/running_program.h"
#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;
using touchtrace::testing::RunningProgram;

constexpr int killed = 128 + 9;

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Tensors of a safetensors file, without the header, whose times differ.
std::string tensors(const fs::path& path) {
  const auto bytes = contents(path);
  std::uint64_t header_bytes = 0;
  if (bytes.size() < sizeof header_bytes) return "not a safetensors file";
  std::memcpy(&header_bytes, bytes.data(), sizeof header_bytes);
  return bytes.substr(sizeof header_bytes + header_bytes);
}

/// Inode number of a file; 0 if it does not exist. Usually differs after a replacement; file
/// systems reuse numbers.
ino_t inode(const fs::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

class InterruptedTraining : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    run("simulate --activity wave --object ball --minutes 0.6 --seed 5 " + at("scene.h5"));
    run("calibrate " + at("scene.h5") + " --output " + at("calibration"));
    run("label " + at("scene.h5") + " --calibration " + at("calibration") + " -o " +
        at("labels.h5"));
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  void run(const std::string& arguments) {
    const auto result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  std::string train(const std::string& output) const {
    return "train --recording " + at("scene.h5") + " --labels " + at("labels.h5") +
           " --updates 150 --sequences 2 --steps 10 --resolution 12 --window 4 "
           "--checkpoint-seconds 0 --output " +
           at(output);
  }

  bool has_temporary_file() const {
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().extension() == ".tmp") return true;
    return false;
  }

  /// Kills training after `num_checkpoints`, while the next one is written if `during_write`.
  /// Returns the exit code.
  int train_and_kill(int num_checkpoints, bool during_write) {
    const fs::path checkpoint = at("killed.checkpoint");
    ino_t last = inode(checkpoint);
    RunningProgram program(train("killed") + (last ? " --resume" : ""), at("killed.log"));
    program.wait_for([&] {
      const ino_t now = inode(checkpoint);
      if (now != last) last = now, --num_checkpoints;
      return num_checkpoints <= 0 && (!during_write || has_temporary_file());
    });
    program.signal(SIGKILL);
    return program.wait();
  }

  void survive_kills() {
    const unsigned seed = std::random_device()();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::minstd_rand random(seed);
    // 150 updates with a checkpoint each: at least six runs, unless polling misses checkpoints.
    std::uniform_int_distribution<int> num_checkpoints(1, 22), coin(0, 1);
    int kills = 0;
    while (!fs::exists(at("killed"))) {
      const int exit_code = train_and_kill(num_checkpoints(random), coin(random) == 1);
      ASSERT_TRUE(exit_code == killed || exit_code == 0) << contents(at("killed.log"));
      kills += exit_code == killed ? 1 : 0;
    }
    EXPECT_GE(kills, 2);
  }

  void lose_the_device() {
    const auto result =
        run_program(train("lost"), "OCL_ICD_VENDORS=" VANISHING_POCL_ICD " VANISHES_AFTER=3000 ");
    EXPECT_EQ(result.exit_code, 4) << result.output;
    for (const char* part : {"CL_DEVICE_NOT_AVAILABLE", "lost.checkpoint", "--resume"})
      EXPECT_NE(result.output.find(part), std::string::npos) << result.output;
    run(train("lost") + " --resume");
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(InterruptedTraining, ResumesToTheSameBits) {
  run(train("whole"));
  survive_kills();
  EXPECT_EQ(tensors(at("killed")), tensors(at("whole")));
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  lose_the_device();
  EXPECT_EQ(tensors(at("lost")), tensors(at("whole")));
}

}  // namespace
