// `touchtrace sweep`: failed cells, kills, interrupts and processes that share a folder.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/end_to_end/running_program.h"
#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using touchtrace::testing::run_program;
using touchtrace::testing::RunningProgram;

const char* const touch_only =
    "[simulate]\nno_images = true\nminutes = 0.1\nactivity = [\"wave\", \"throw\"]\nseed = [1, 2]\n"
    "[check]\nfile = \"@simulate\"\n";

class Sweep : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_study(touch_only);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  void write_study(const std::string& text) const { std::ofstream(at("study.toml")) << text; }
  std::string sweep(const std::string& output) const {
    return "sweep " + at("study.toml") + " --output " + at(output);
  }
  /// Content of a file, with the folder of the output replaced.
  std::string contents(const std::string& output, const std::string& name) const {
    std::ostringstream stream;
    stream << std::ifstream(folder_ / output / name).rdbuf();
    std::string text = stream.str();
    for (auto i = text.find(at(output)); i != std::string::npos; i = text.find(at(output)))
      text.replace(i, at(output).size(), "OUTPUT");
    return text;
  }
  int count(const std::string& output, const std::string& prefix) const {
    int found = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / output))
      found += entry.path().filename().string().starts_with(prefix);
    return found;
  }
  void expect_equal_results(const std::string& a, const std::string& b) const {
    for (const char* name : {"results.csv", "metrics.json", "table.md", "table.tex"}) {
      EXPECT_FALSE(contents(a, name).empty()) << name;
      EXPECT_EQ(contents(a, name), contents(b, name)) << name;
    }
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(Sweep, StudiesOfTheProjectAreValid) {
  int studies = 0;
  for (const auto& file : fs::directory_iterator(TOUCHTRACE_SOURCE_DIR "/scripts/studies")) {
    const auto result =
        run_program("sweep " + file.path().string() + " --dry-run --output " + at("out"));
    EXPECT_EQ(result.exit_code, 0) << file.path() << result.output;
    ++studies;
  }
  EXPECT_GE(studies, 7);
}

TEST_F(Sweep, ResumesAfterKillsToTheSameBytes) {
  ASSERT_EQ(run_program(sweep("whole")).exit_code, 0);
  for (int cells = 1; cells < 6; cells += 2) {
    RunningProgram program(sweep("killed") + " --jobs 2", at("log"));
    ASSERT_TRUE(program.wait_for([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return fs::exists(at("killed")) && count("killed", "result.json") >= cells &&
             count("killed", "claim.") > 0;
    }));
    program.signal(SIGKILL);
    program.wait();
  }
  const auto last = run_program(sweep("killed") + " --json --quiet");
  ASSERT_EQ(last.exit_code, 0) << last.output;
  EXPECT_GT(json::parse(last.output)["reused"], 0);
  expect_equal_results("whole", "killed");
}

TEST_F(Sweep, ProcessesShareAFolder) {
  ASSERT_EQ(run_program(sweep("whole")).exit_code, 0);
  RunningProgram first(sweep("shared") + " --shard 1/2", at("log1"));
  RunningProgram second(sweep("shared") + " --shard 2/2", at("log2"));
  EXPECT_EQ(first.wait(), 0);
  EXPECT_EQ(second.wait(), 0);
  const auto rest = json::parse(run_program(sweep("shared") + " --json").output);
  EXPECT_EQ(rest["reused"], 8);
  expect_equal_results("whole", "shared");
}

TEST_F(Sweep, ShowsAFailedCellAndFinishesTheOthers) {
  write_study(
      "[simulate]\nno_images = true\nminutes = 0.1\nobject = [\"ball\", \"bal\"]\n"
      "[check]\nfile = \"@simulate\"\n");
  const auto result = run_program(sweep("out"));
  EXPECT_EQ(result.exit_code, 1);
  for (const char* part : {"failed: simulate object=bal\n", "did you mean 'ball'", "log.txt",
                           "1 cells failed, 1 that need them were skipped", "hint: "})
    EXPECT_NE(result.output.find(part), std::string::npos) << part << "\n" << result.output;
  EXPECT_EQ(count("out", "result.json"), 2);
}

TEST_F(Sweep, InterruptEndsTheChildren) {
  write_study("[simulate]\nno_images = true\nminutes = 9000\n");
  RunningProgram program(sweep("out"), at("log"));
  ASSERT_TRUE(program.wait_for(
      [&] { return fs::exists(at("out/cells")) && count("out", ".recording.h5") > 0; }));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 130);
  EXPECT_EQ(count("out", "claim."), 0);
  EXPECT_EQ(count("out", ".recording.h5"), 0) << "temporary file of the child";
}

TEST_F(Sweep, SlurmArraysAreSubmittedUntilAllCellsAreSettled) {
  // The first array runs its first task only, as if a time limit had ended the second.
  fs::create_directories(at("bin"));
  std::ofstream(at("bin/sbatch")) << "#!/bin/sh\necho x >>" + at("submitted") +
                                         "\nfor id in 1 $([ $(wc -l <" + at("submitted") +
                                         ") -gt 1 ] && echo 2); do\n"
                                         "  SLURM_ARRAY_TASK_ID=$id sh $2 >/dev/null 2>&1\n"
                                         "done\necho 'sbatch: warning' >&2\necho '42;cluster'\n";
  std::ofstream(at("bin/squeue")) << "#!/bin/sh\necho warning >&2\n[ \"$3\" = --jobs=42 ]\n";
  for (const char* name : {"bin/sbatch", "bin/squeue"})
    fs::permissions(at(name), fs::perms::owner_all);
  const auto path = "PATH=" + at("bin") + ":$PATH ";
  const auto result =
      run_program(sweep("out") + " --launcher slurm --tasks 2 --set simulate.seed=1 --json", path);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(json::parse(result.output)["done"], 4);
  EXPECT_EQ(fs::file_size(at("submitted")), 4u) << "two lines";
  std::ofstream(at("bin/sbatch")) << "#!/bin/sh\necho no partition; exit 1\n";
  const auto refused = run_program(sweep("other") + " --launcher slurm", path);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.output.find("no partition"), std::string::npos) << refused.output;
}

TEST_F(Sweep, DryRunPredictsTheTime) {
  const auto before = json::parse(run_program(sweep("out") + " --dry-run --json").output);
  EXPECT_EQ(before["stages"].back()["cells"], 8);
  EXPECT_TRUE(before["stages"].back()["predicted_seconds"].is_null());
  EXPECT_FALSE(fs::exists(at("out")));
  ASSERT_EQ(run_program(sweep("out") + " --set simulate.seed=1").exit_code, 0);
  const auto after = json::parse(run_program(sweep("out") + " --dry-run --json").output);
  EXPECT_EQ(after["stages"].back()["done"], 4);
  EXPECT_GT(after["stages"].back()["predicted_seconds"], 0.0);
}

}  // namespace
