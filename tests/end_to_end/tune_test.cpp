// `touchtrace tune` and what others make of the file that it leaves.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::run_program;

/// A small update, with caches of its own.
class Tune : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(cache_);
    fs::create_directories(cache_);
  }
  void TearDown() override { fs::remove_all(cache_); }

  auto run(const std::string& command) const {
    return run_program(command + " --window 2 --resolution 6 --sequences 1 --steps 4",
                       "XDG_CACHE_HOME=" + cache_.string() + " ");
  }
  nlohmann::json json_of(const std::string& command) const {
    const auto output = run(command + " --json").output;
    return nlohmann::json::parse(output.substr(output.find("{\n")));  // after what stderr says
  }
  int tuned_launches() const {
    int tuned = 0;
    const auto plan = json_of("plan");
    for (const auto& launch : plan.at("launches")) tuned += launch.at("tuned") ? 1 : 0;
    return tuned;
  }

  fs::path cache_ = touchtrace::testing::scratch_folder();
  fs::path file_ = cache_ / "touchtrace" / "tuning.json";
};

TEST_F(Tune, IsKeptUsedByThePlanAndIgnoredIfDamaged) {
  EXPECT_EQ(tuned_launches(), 0);
  const auto first = json_of("tune");
  EXPECT_FALSE(first.at("was_complete"));
  EXPECT_EQ(first.at("path"), file_.string());
  EXPECT_EQ(first.at("tuning").at("layers").size(), 3u);
  EXPECT_GT(first.at("update").at("tuned_ms").get<double>(), 0.0);
  const auto second = json_of("tune");
  EXPECT_TRUE(second.at("was_complete"));
  EXPECT_EQ(second.at("tuning"), first.at("tuning"));
  EXPECT_GE(tuned_launches(), 9) << "three layers forwards and backwards";

  std::ofstream(file_) << "{";
  const auto plan = run("plan");
  EXPECT_EQ(plan.exit_code, 0) << plan.output;
  EXPECT_NE(plan.output.find("warning: tuning in "), std::string::npos) << plan.output;
  EXPECT_EQ(tuned_launches(), 0);
}

TEST_F(Tune, SaysWhereItCannotKeepAnything) {
  std::ofstream(cache_ / "touchtrace") << "not a folder";
  const auto result = run("tune");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("hint:"), std::string::npos) << result.output;
}

}  // namespace
