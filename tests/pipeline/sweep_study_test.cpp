// Studies: from TOML to cells, with commands that exist in this test only.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "engine/base/error.h"
#include "pipeline/sweep/cells.h"
#include "pipeline/sweep/run_cells.h"
#include "tests/support/scratch.h"

namespace {

using namespace touchtrace;
using namespace touchtrace::sweep;
using nlohmann::json;

/// Options of both commands of the test: "make" and "use".
struct TestOptions {
  std::string output, kind = "small", file;
  std::vector<std::string> files;
  int size = 3;
  bool fast = false;
};

OptionSet describe_test(const std::string& command, TestOptions& o) {
  if (command != "make" && command != "use") throw usage_error("unknown command", "make, use");
  OptionSet set;
  set.path("output", o.output, "file");
  set.choice("kind", o.kind, "kind", {"small", "large"});
  set.integer("size", o.size, "size", 1, 100);
  set.flag("fast", o.fast, "fast");
  if (command == "use")
    set.text("file", o.file, "one").value("FILE"), set.texts("files", o.files, "several");
  return set;
}

/// Assigns "--name=value" like the program's parser.
json values_of(const std::string& command, const std::vector<std::string>& arguments) {
  TestOptions o;
  const OptionSet set = describe_test(command, o);
  for (const auto& argument : arguments) {
    const auto equals = argument.find('=');
    const auto value = argument.substr(std::min(argument.size(), equals + 1));
    for (const Option& option : set.options()) {
      if (option.label() != argument.substr(0, equals)) continue;
      if (option.is_flag()) *std::get<bool*>(option.target) = true;
      if (auto* text = std::get_if<std::string*>(&option.target)) **text = value;
      if (auto* number = std::get_if<int*>(&option.target)) **number = std::stoi(value);
      if (auto* list = std::get_if<std::vector<std::string>*>(&option.target))
        (*list)->push_back(value);
    }
  }
  set.validate();
  return set.values();
}

CommandTable test_commands(const std::string& version = "1") {
  static TestOptions options;
  return {version,
          [](const std::string& command) { return describe_test(command, options).options(); },
          values_of};
}

class SweepStudy : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<Cell> cells(const std::string& text, const std::vector<std::string>& changes = {}) {
    const auto file = folder_ / "study.toml";
    std::ofstream(file) << text;
    const auto commands = test_commands();
    return expand(read_study(file, changes, commands), commands, "out");
  }
  void expect_refused(const std::string& text, const std::string& message,
                      const std::vector<std::string>& changes = {}) {
    try {
      cells(text, changes);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
      EXPECT_FALSE(error.hint().empty());
    }
  }

  std::filesystem::path folder_ = touchtrace::testing::scratch_folder();
};

const std::string two_stages =
    "[make]\nsize = [1, 2, 3]\nkind = [\"small\", \"large\"]\n"
    "[use]\nfile = \"@make\"\nspeed.slow = {}\nspeed.quick = { fast = true, size = 7 }\n";

TEST_F(SweepStudy, AxesMultiplyAndGoAlongWithReferences) {
  const auto all = cells(two_stages);
  ASSERT_EQ(all.size(), 6u + 12u);
  EXPECT_EQ(all[0].axes, json({{"kind", "small"}, {"size", 1}}));
  const Cell& last = all.back();
  EXPECT_EQ(last.axes, json({{"kind", "large"}, {"size", 3}, {"speed", "slow"}}));
  ASSERT_EQ(last.inputs.size(), 1u);
  EXPECT_EQ(last.options["file"], all[last.inputs[0]].output.string());
  EXPECT_EQ(all[last.inputs[0]].axes, json({{"kind", "large"}, {"size", 3}}));
  EXPECT_EQ(all[6].arguments,
            (std::vector<std::string>{"--output=" + all[6].output.string(), "--size=7", "--fast",
                                      "--file=" + all[0].output.string()}));
}

TEST_F(SweepStudy, GatheredAxesGiveOneCellWithAllValues) {
  const auto all = cells(
      "[make]\nsize = [1, 2, 3]\nkind = [\"small\", \"large\"]\n"
      "[use]\ngather = [\"size\"]\nfiles = \"@make\"\n");
  ASSERT_EQ(all.size(), 6u + 2u);
  EXPECT_EQ(all[7].axes, json({{"kind", "large"}}));
  EXPECT_EQ(all[7].inputs, (std::vector<std::size_t>{3, 4, 5}));
  EXPECT_EQ(all[7].options["files"].size(), 3u);
}

TEST_F(SweepStudy, AnAxisWithOneValueCanBeGathered) {
  const auto all = cells(
      "[make]\nsize = 2\nkind = [\"small\", \"large\"]\n"
      "[use]\ngather = [\"size\", \"make.size\"]\nfiles = \"@make\"\n");
  ASSERT_EQ(all.size(), 2u + 2u);
  EXPECT_EQ(all[3].axes, json({{"kind", "large"}}));
}

TEST_F(SweepStudy, LabelsOfARecordingArePartOfItsCells) {
  const auto id = [&] {
    return cells("[use]\nfile = \"" + (folder_ / "r.h5").string() + "\"\n").at(0).id;
  };
  std::ofstream(folder_ / "r.h5") << "recording";
  const auto without_labels = id();
  std::ofstream(folder_ / "r.labels.h5") << "labels";
  const auto with_labels = id();
  EXPECT_NE(with_labels, without_labels);
  std::ofstream(folder_ / "r.labels.h5") << "other labels";
  EXPECT_NE(id(), with_labels);
}

TEST_F(SweepStudy, EqualValuesOfAnAxisAreRefused) {
  expect_refused("[make]\nsize = [1, 2, 1]\n", "axis 'size' has 1 twice");
}

TEST_F(SweepStudy, AnotherCommitHasOtherCells) {
  const auto file = folder_ / "study.toml";
  std::ofstream(file) << two_stages;
  std::set<std::string> ids;
  for (const char* version : {"0.1.0 (commit a)", "0.1.0 (commit b)"}) {
    const auto commands = test_commands(version);
    for (const Cell& cell : expand(read_study(file, {}, commands), commands, "out"))
      ids.insert(cell.id);
  }
  EXPECT_EQ(ids.size(), 2u * (6u + 12u));
}

TEST_F(SweepStudy, ValuesOfOtherStagesAndAxesOfOneName) {
  const auto all = cells(
      "[make]\nsize = [4, 5]\n[use]\nfile = \"@make\"\nsize = \"@make.size\"\n"
      "[other]\ncommand = \"use\"\nfile = \"@make\"\nsize = [8, 9]\n");
  ASSERT_EQ(all.size(), 2u + 2u + 4u);
  EXPECT_EQ(all[3].options["size"], 5);
  EXPECT_EQ(all[7].axes, json({{"size", 5}, {"other.size", 9}}));
}

TEST_F(SweepStudy, ValueReferencesStandForTheCommonValueOfGatheredCells) {
  const auto all = cells(
      "[make]\nkind = [\"small\", \"large\"]\nsize = [4, 5]\n"
      "[other]\ncommand = \"make\"\ngather = [\"size\"]\nkind = \"@make.kind\"\n");
  ASSERT_EQ(all.size(), 4u + 2u);
  EXPECT_EQ(all[4].options["kind"], "small");
  EXPECT_EQ(all[5].options["kind"], "large");
  expect_refused(
      "[make]\nsize = [4, 5]\n"
      "[other]\ncommand = \"make\"\ngather = [\"size\"]\nsize = \"@make.size\"\n",
      "'@make.size' stands for 2 values, not one");
}

TEST_F(SweepStudy, IdsDependOnWhatDeterminesTheResult) {
  const auto id = [&](const std::string& text) { return cells(text).back().id; };
  const std::string use = "\n[use]\nfile = \"@make\"\n";
  const auto base = id("[make]\nsize = 3" + use);
  EXPECT_EQ(base.size(), std::string("use-").size() + 16);
  EXPECT_EQ(id("[make]" + use), base) << "a default that is written out";
  EXPECT_EQ(id("[first]\ncommand = \"make\"\n[use]\nfile = \"@first\"\n"), base) << "a name";
  EXPECT_NE(id("[make]\nsize = 4" + use), base) << "an option of the input";
  EXPECT_NE(id("[make]" + use + "fast = true\n"), base);
}

TEST_F(SweepStudy, IdsDependOnTheContentOfOutsideFiles) {
  const auto file = (folder_ / "data.csv").string();
  const auto id = [&](const char* content) {
    std::ofstream(file) << content;
    return cells("[use]\nfile = \"" + file + "\"\n")[0].id;
  };
  const auto first = id("1");
  EXPECT_NE(id("22"), first);
  std::filesystem::remove(file);
  std::filesystem::create_directories(file);
  std::ofstream(file + "/part") << "1";
  const auto folder = cells("[use]\nfile = \"" + file + "\"\n")[0].id;
  std::ofstream(file + "/part") << "22";
  EXPECT_NE(cells("[use]\nfile = \"" + file + "\"\n")[0].id, folder);
}

TEST_F(SweepStudy, ChangesReplaceValuesAndSelectCases) {
  EXPECT_EQ(cells(two_stages, {"make.size=1:5", "use.speed=quick"}).size(), 10u + 10u);
  EXPECT_EQ(cells(two_stages, {"make.size=7", "make.kind=small,large"})[1].axes,
            json({{"kind", "large"}}));
  EXPECT_EQ(cells("[use]\n", {"use.files=\"a,b\""})[0].options["files"], "a,b");
  EXPECT_EQ(cells("[use]\n", {"use.files=a,b"})[0].options["files"], json({"a", "b"}));
  expect_refused(two_stages, "unknown stage 'mak'", {"mak.size=1"});
  expect_refused(two_stages, "unknown case 'quik'", {"use.speed=quik"});
  expect_refused(two_stages, "cannot set 'size'", {"size"});
  expect_refused(two_stages, "is not a range", {"make.size=5:1"});
}

TEST_F(SweepStudy, MistakesAreNamed) {
  expect_refused("[make\n", "study.toml:1");
  expect_refused("", "has no stages");
  expect_refused("size = 1\n", "key 'size' is outside any table");
  expect_refused("[mak]\n", "[mak]: unknown command");
  expect_refused("[make]\nsise = 1\n", "unknown key 'sise'; did you mean 'size'?");
  expect_refused("[make]\nsize = 1000\n", "[make]: --size must be from 1 to 100, not 1000");
  expect_refused("[make]\nkind = [\"small\", \"larg\"]\n", "did you mean 'large'");
  expect_refused("[make]\nsize = []\n", "axis 'size' has no values");
  expect_refused("[make]\nsize = true\n", "size cannot be true");
  expect_refused("[make]\nfast = 1\n", "fast cannot be 1");
  expect_refused("[make]\nv.a = 3\n", "'v.a' is not a table");
  expect_refused("[make]\nv.a = { sise = 1 }\n", "unknown key 'sise'");
  expect_refused("[make]\noutput = \"../x\"\n", "output cannot be");
  expect_refused("[make]\n[use]\nfile = \"@mak\"\n", "'@mak' refers to no stage above");
  expect_refused("[use]\nfile = \"@use\"\n", "refers to no stage above");
  expect_refused("[use]\nfile = \"missing.h5\"\n", "file: there is no file or folder 'missing.h5'");
  expect_refused("[make]\nsize = [1, 2]\n[use]\ngather = [\"size\"]\nfile = \"@make\"\n",
                 "stands for 2 cells, not one");
  expect_refused("[make]\nsize = [1, 2]\n[use]\ngather = [\"make.size\"]\nfiles = \"@make\"\n",
                 "unknown axis 'make.size'");
  expect_refused("[make]\n[use]\ngather = [\"seed\"]\nfiles = \"@make\"\n", "unknown axis 'seed'");
  expect_refused("[make]\n[use]\nfile = \"@make\"\nsize = \"@make.size\"\n", "is not given");
  expect_refused("[make]\nsize = 1\nkind = " + std::string(9000, '[') + "\n", "study.toml:");
}

TEST_F(SweepStudy, TooManyCellsAreRefused) {
  std::string text = "[make]\n";
  for (int axis = 0; axis < 9; ++axis)
    for (int value = 0; value < 9; ++value)
      text += "a" + std::to_string(axis) + ".v" + std::to_string(value) + " = {}\n";
  expect_refused(text, "more than 100000 cells");
  std::string sizes;
  for (int size = 1; size <= 100; ++size) sizes += std::to_string(size) + ",";
  const std::string axes = "size = [" + sizes + "]\nkind = [\"small\", \"large\"]\nfast = ";
  expect_refused("[make]\n" + axes +
                     "true\n[other]\ncommand = \"make\"\nv.a = {}\nv.b = {}\nv.c = {}\n" + axes +
                     "[true, false]\n[use]\nfiles = [\"@make\", \"@other\"]\n",
                 "more than 100000 cells");
}

TEST_F(SweepStudy, ShardsCoverEveryCellWithItsInputs) {
  const auto all = cells(two_stages);
  std::vector<int> last_stage(all.size());
  for (std::size_t index = 0; index < 5; ++index) {
    const auto selected = cells_of({index, 5}, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!selected[i]) continue;
      last_stage[i] += all[i].stage == "use";
      for (const std::size_t input : all[i].inputs) EXPECT_TRUE(selected[input]);
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(last_stage[i], all[i].stage == "use");
  for (const char* text : {"0/4", "5/4", "1", "1/2/3", "a/b"})
    EXPECT_THROW(parse_shard(text), Error) << text;
  EXPECT_EQ(parse_shard("4/4").index, 3u);
}

}  // namespace
