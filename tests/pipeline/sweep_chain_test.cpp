// Studies that are given as commands of the program.
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/cli/command_table.h"
#include "pipeline/sweep/cells.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace::sweep {
namespace {

std::vector<Cell> cells_of(const std::string& chain, const std::vector<std::string>& changes) {
  const CommandTable commands = cli::command_table();
  return expand(read_study(chain, changes, commands), commands, "out");
}

TEST(SweepChain, EvaluatesAllModelsOfTheSameRecordingTogether) {
  const testing::TemporaryFolder folder;
  const std::string recording = (folder / "a.h5").string();
  write_file(recording, "a recording", true);
  const auto cells = cells_of("train+evaluate", {"recording=" + recording, "seed=1:2",
                                                 "resolution=32,16", "without_touch=false,true"});
  ASSERT_EQ(cells.size(), 9u);
  const Cell& evaluation = cells.back();
  EXPECT_EQ(evaluation.command, "evaluate");
  EXPECT_EQ(evaluation.inputs.size(), 8u);
  EXPECT_EQ(evaluation.options.at("model").size(), 8u);
  EXPECT_EQ(evaluation.options.at("recording"), nlohmann::json{recording});
}

TEST(SweepChain, RecordingsOfOneTrainingAreEvaluatedTogether) {
  const testing::TemporaryFolder folder;
  const std::string a = (folder / "a.h5").string(), b = (folder / "b.h5").string();
  for (const auto& recording : {a, b}) write_file(recording, "a recording", true);
  const auto cells = cells_of("train+evaluate", {"recording=" + a + "," + b, "seed=1:2"});
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells.back().options.at("recording"), (nlohmann::json{a, b}));
}

TEST(SweepChain, StagesUseWhatEarlierOnesWrite) {
  const auto cells =
      cells_of("simulate+label+train+evaluate", {"activity=wave,throw", "train.seed=1:3"});
  ASSERT_EQ(cells.size(), 2u + 2u + 6u + 2u);
  const Cell& evaluation = cells.back();
  EXPECT_EQ(evaluation.options.at("labels"), nlohmann::json{cells[3].output.string()});
  EXPECT_EQ(evaluation.options.at("model").size(), 3u);
}

TEST(SweepChain, MistakesAreNamed) {
  const auto message_of = [](const std::string& chain, const std::vector<std::string>& changes) {
    try {
      cells_of(chain, changes);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      return std::string(error.what()) + error.hint();
    }
    return std::string();
  };
  EXPECT_NE(message_of("trian+evaluate", {}).find("trian"), std::string::npos);
  EXPECT_NE(message_of("train", {"sead=1:2"}).find("no stage has the option 'sead'"),
            std::string::npos);
  EXPECT_NE(message_of("train", {"seed=1:2"}).find("recording"), std::string::npos);
  EXPECT_NE(message_of("train", {"seed=1:2", "train.seed=4"}).find("'train.seed' is set twice"),
            std::string::npos);
}

}  // namespace
}  // namespace touchtrace::sweep
