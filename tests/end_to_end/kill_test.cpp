// `touchtrace train` killed at random moments, or left by its device, and resumed until it is done:
// the weights must be those of a run that went through.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;

constexpr int killed = 128 + 9;

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The tensors of a safetensors file; its header holds times, which differ.
std::string tensors(const fs::path& path) {
  const auto bytes = contents(path);
  std::uint64_t header_bytes = 0;
  if (bytes.size() < sizeof header_bytes) return "not a safetensors file";
  std::memcpy(&header_bytes, bytes.data(), sizeof header_bytes);
  return bytes.substr(sizeof header_bytes + header_bytes);
}

class BrokenTraining : public ::testing::Test {
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
           " --updates 400 --sequences 2 --steps 10 --resolution 12 --window 4 "
           "--checkpoint-seconds 0 --output " +
           at(output);
  }

  void survive_kills() {
    std::random_device seed;
    std::uniform_real_distribution<double> moment_s(0.2, 0.8);
    int kills = 0;
    for (int start = 0; start < 60 && !fs::exists(at("killed")); ++start) {
      const bool resume = fs::exists(at("killed.checkpoint"));
      // Later starts live longer, so that this ends on a slow machine too. --foreground: timeout
      // waits until the process is gone, and so are its claims on temporary files.
      // --preserve-status: a run that ends just as its time is up has ended well.
      const auto limit_s = std::to_string(moment_s(seed) * (1.0 + 0.2 * start));
      const auto result =
          run_program(train("killed") + (resume ? " --resume" : ""),
                      "timeout --foreground --preserve-status -s KILL " + limit_s + " ");
      if (result.exit_code == killed)
        ++kills;
      else
        ASSERT_EQ(result.exit_code, 0) << result.output;
    }
    ASSERT_TRUE(fs::exists(at("killed")));
    EXPECT_GE(kills, 2);
  }

  void lose_the_device() {
    const auto result =
        run_program(train("left"), "OCL_ICD_VENDORS=" VANISHING_POCL_ICD " VANISHES_AFTER=3000 ");
    EXPECT_EQ(result.exit_code, 4) << result.output;
    for (const char* part : {"CL_DEVICE_NOT_AVAILABLE", "left.checkpoint is whole", "--resume"})
      EXPECT_NE(result.output.find(part), std::string::npos) << result.output;
    run(train("left") + " --resume");
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(BrokenTraining, GoesOnToTheSameBits) {
  run(train("whole"));
  survive_kills();
  EXPECT_EQ(tensors(at("killed")), tensors(at("whole")));
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  lose_the_device();
  EXPECT_EQ(tensors(at("left")), tensors(at("whole")));
}

}  // namespace
