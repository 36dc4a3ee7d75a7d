#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/sweep/collect.h"
#include "pipeline/sweep/event_file.h"
#include "pipeline/sweep/summary_table.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using namespace touchtrace;
using namespace touchtrace::sweep;
using nlohmann::json;

class SweepCollect : public ::testing::Test {
 protected:
  void SetUp() override {
    add("evaluate", {{"seed", 1}}, {{"results", {row("full", 1.0), row("random", 5.0)}}});
    add("evaluate", {{"seed", 2}}, {{"results", {row("full", 3.0), row("random", nullptr)}}});
    add("train", {{"seed", 2}},
        {{"card", {{"log", {{{"update", 10}, {"seconds", 1.5}, {"loss", 0.25}}}}}}});
    cells_.push_back({{"id", "missing"}, {"stage", "x"}, {"axes", json::object()}, {"output", ""}});
    write_file(folder_ / "study.json", json{{"cells", cells_}}.dump(), true);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static json row(const char* model, const json& l1) {
    return {{"model", model}, {"l1", l1}, {"note", "a,\"b\""}, {"path", "x/y"}, {"ci", {1, 2}}};
  }
  void add(const std::string& stage, const json& axes, const json& result) {
    const auto id = stage + std::to_string(cells_.size());
    cells_.push_back({{"id", id}, {"stage", stage}, {"axes", axes}, {"output", "f"}});
    write_file(folder_ / "cells" / id / "result.json", result.dump(), true);
  }
  std::string written(const std::string& name) const { return read_file(folder_ / name); }

  json cells_ = json::array();
  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(SweepCollect, RowsThatPoolSeedsCountThem) {
  json full = row("full", 1.0);
  full["runs"] = 3;
  add("evaluate", {{"seed", 3}}, {{"results", {full}}, {"main_metrics", {"l1"}}});
  write_file(folder_ / "study.json", json{{"cells", cells_}}.dump(), true);
  collect(folder_, {});
  EXPECT_NE(written("table.md").find("| full | a,\"b\" | 1.667 +- 1.155 | 5 |"), std::string::npos)
      << written("table.md");
}

TEST_F(SweepCollect, WritesRowsAndTables) {
  const auto summary = collect(folder_, {});
  EXPECT_EQ(summary["rows"], 4);
  EXPECT_EQ(summary["missing_cells"], 1);
  EXPECT_EQ(written("results.csv"),
            "seed,l1,model,note,path\n"
            "1,1.0,full,\"a,\"\"b\"\"\",x/y\n1,5.0,random,\"a,\"\"b\"\"\",x/y\n"
            "2,3.0,full,\"a,\"\"b\"\"\",x/y\n2,,random,\"a,\"\"b\"\"\",x/y\n");
  EXPECT_EQ(written("table.md"),
            "| model | note | l1 | n |\n|---|---|---|---|\n"
            "| full | a,\"b\" | 2 +- 1.414 | 2 |\n| random | a,\"b\" | 5 | 2 |\n");
  EXPECT_NE(written("table.tex").find("full & a,\"b\" & $2 \\pm 1.414$ & 2 \\\\"),
            std::string::npos);
  const json metrics = json::parse(written("metrics.json"));
  EXPECT_EQ(metrics["results"].size(), 4u);
  EXPECT_EQ(metrics["summary"][0]["l1"]["mean"], 2.0);
}

TEST_F(SweepCollect, OptionsOfResultsAreAxes) {
  json full = row("full size=8", 1.0), small = row("full size=4", 2.0);
  full["options"] = {{"size", 8}}, small["options"] = {{"size", 4}};
  add("evaluate", {{"seed", 3}}, {{"results", {full, small}}});
  write_file(folder_ / "study.json", json{{"cells", cells_}}.dump(), true);
  collect(folder_, {"l1"});
  const auto csv = written("results.csv");
  EXPECT_NE(csv.find("seed,size,l1,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("3,8,1.0,full size=8,"), std::string::npos) << csv;
  EXPECT_NE(written("table.md").find("| 4 | full size=4 | a,\"b\" | 2 | 1 |"), std::string::npos)
      << written("table.md");
}

TEST_F(SweepCollect, TablesHaveTheMainMetrics) {
  json full = row("full", 1.0);
  full["l2"] = 2.0, full["l3"] = 3.0;
  add("evaluate", {{"seed", 3}}, {{"results", {full}}, {"main_metrics", {"l2", "l1", "l0"}}});
  write_file(folder_ / "study.json", json{{"cells", cells_}}.dump(), true);
  collect(folder_, {});
  EXPECT_TRUE(written("table.md").starts_with("| model | note | l2 | l1 | n |"))
      << written("table.md");
  EXPECT_NE(written("results.csv").find("l3"), std::string::npos);
  EXPECT_EQ(json::parse(written("metrics.json"))["summary"][0]["l3"]["mean"], 3.0);
  collect(folder_, {"l3"});
  EXPECT_TRUE(written("table.md").starts_with("| model | note | l3 | n |"));
}

TEST_F(SweepCollect, WritesCurvesForTensorBoard) {
  collect(folder_, {});
  const auto bytes = written("tensorboard/train/2/events.out.tfevents.0.touchtrace");
  // A record: length, its checksum, data, checksum. The first one names the version.
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  EXPECT_EQ(bytes.substr(12, length).substr(11), "brain.Event:2");
  std::uint32_t checksum = 0;  // expected value: masked_crc32c of the package tensorboard
  std::memcpy(&checksum, bytes.data() + 8, sizeof checksum);
  EXPECT_EQ(length, 24u);
  EXPECT_EQ(checksum, 0x224b7fa3u);
  EXPECT_NE(bytes.find("loss"), std::string::npos);
  EXPECT_EQ(bytes.find("seconds"), std::string::npos);
  EXPECT_EQ(event_file_of({{"results", 3}}), "");
}

TEST_F(SweepCollect, RefusesWhatIsNotASweep) {
  EXPECT_THROW(collect(folder_ / "cells", {}), Error);
  EXPECT_THROW(collect(folder_, {"l2"}), Error);
  for (const char* text : {"[", "{}", "[1]", R"({"cells": [{"id": 3}]})"}) {
    write_file(folder_ / "study.json", text, true);
    EXPECT_THROW(collect(folder_, {}), Error) << text;
  }
  write_file(folder_ / "study.json", json{{"cells", cells_}}.dump(), true);
  write_file(folder_ / "cells" / "train2" / "result.json", "not JSON", true);
  EXPECT_THROW(collect(folder_, {}), Error);
}

TEST(SweepRows, AnAxisKeepsItsNameUnlessAFieldDiffers) {
  const auto rows = rows_of({{"s",
                              {{"model", "a"}, {"size", 3}},
                              {{"results", {{{"model", "b"}, {"size", 3}}}}},
                              0.0,
                              {}}});
  EXPECT_EQ(columns_of(rows), (std::vector<std::string>{"axis.model", "size", "model"}));
}

}  // namespace
