#include "pipeline/acquire/record/glove_config.h"

#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/session.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/command_line.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::TemporaryFolder;

GloveInfo small_glove() {
  GloveInfo info;
  info.rows = 2, info.cols = 3, info.bits = 10, info.rate_hz = 25.0;
  return info;
}

json config() {
  LearnedGlove learned;
  learned.polarity = -1;
  learned.baseline_counts = {900, 901, 902.5, 903, 904, 1023};
  return glove_config_json("mit-rows", small_glove(), learned);
}

TEST(GloveConfig, ReadsWhatLearningWrites) {
  const TemporaryFolder folder;
  testing::put(folder / "glove.json", config().dump(2));
  const GloveConfig read = read_glove_config(folder / "glove.json");
  EXPECT_EQ(read.protocol, "mit-rows");
  EXPECT_EQ(read.rows, 2);
  EXPECT_EQ(read.cols, 3);
  EXPECT_EQ(read.bits, 10);
  EXPECT_EQ(read.polarity, -1);
  EXPECT_DOUBLE_EQ(read.rate_hz, 25.0);
  EXPECT_EQ(read.baseline_counts, (std::vector<float>{900, 901, 902.5, 903, 904, 1023}));
}

TEST(GloveConfig, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto expect_rejected = [&](const std::string& text, const std::string& fault) {
    testing::put(folder / "glove.json", text);
    try {
      read_glove_config(folder / "glove.json");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data);
      EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("glove.json"), std::string::npos);
    }
  };
  expect_rejected("", "");
  expect_rejected("[1, 2]", "");
  expect_rejected("{}", "schema");
  const std::vector<std::pair<json, const char*>> faults{
      {{{"schema", "touchtrace/glove/9"}}, "schema"},
      {{{"rows", 1e9}}, "rows"},
      {{{"rows", 3}}, "baseline_counts"},
      {{{"cols", nullptr}}, ""},
      {{{"bits", 0}}, "bits"},
      {{{"bits", 9}}, "baseline_counts"},
      {{{"polarity", 0}}, "polarity"},
      {{{"rate_hz", 0.0}}, "rate_hz"},
      {{{"baseline_counts", {1, 2, 3, 4, 5, -6}}}, "baseline_counts"},
      {{{"baseline_counts", {1, 2, 3, 4, 5, nullptr}}}, ""},
      {{{"faults", 3}}, ""}};
  for (const auto& [change, fault] : faults) {
    json changed = config();
    changed.update(change);
    expect_rejected(changed.dump(), fault);
  }
  EXPECT_THROW(read_glove_config(folder / "missing.json"), Error);
}

/// 60 frames of 2 x 3 taxels in the file "glove.bin".
std::vector<std::uint16_t> write_frames(const TemporaryFolder& folder) {
  GloveStream glove;
  glove.info = small_glove();
  for (std::size_t i = 0; i < 60; ++i) {
    glove.sequence.push_back(i);
    for (int k = 0; k < 6; ++k) glove.counts.push_back(static_cast<std::uint16_t>(800 + i + k));
  }
  std::string bytes;
  for (std::size_t i = 0; i < 60; ++i) bytes += encode_mit_rows(glove, i);
  testing::put(folder / "glove.bin", bytes);
  return glove.counts;
}

TEST(GloveConfig, RecordUsesIt) {
  const TemporaryFolder folder;
  testing::put(folder / "glove.json", config().dump(2));
  const auto counts = write_frames(folder);
  const auto record = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"record",
                                 "--glove",
                                 (folder / "glove.bin").string(),
                                 "--speed",
                                 "0",
                                 "--glove-config",
                                 (folder / "glove.json").string(),
                                 "--output",
                                 (folder / "a.h5").string(),
                                 "--overwrite"};
    all.insert(all.end(), more.begin(), more.end());
    return testing::run_touchtrace(all);
  };
  ASSERT_EQ(record({"--protocol", "mit-rows"}), 0);
  const RecordingReader reader(folder / "a.h5");
  const GloveInfo& info = reader.recording().gloves.at(0).info;
  EXPECT_EQ(info.baseline_counts, (std::vector<float>{900, 901, 902.5, 903, 904, 1023}));
  EXPECT_EQ(info.polarity, -1);
  EXPECT_EQ(info.bits, 10);
  EXPECT_NEAR(info.rate_hz, 25.0, 1.0);
  EXPECT_EQ(reader.recording().gloves[0].counts, counts);
  EXPECT_LT(reader.recording().clips.at(0).start_s, reader.recording().gloves[0].host_time_s[0]);
  EXPECT_EQ(record({"--protocol", "mit-rows", "--polarity", "1"}), 0) << "options come first";
  EXPECT_EQ(RecordingReader(folder / "a.h5").recording().gloves.at(0).info.polarity, 1);
  EXPECT_EQ(record({"--protocol", "stag"}), 3) << "of another protocol";
  EXPECT_EQ(record({"--protocol", "mit-rows", "--rows", "4"}), 2) << "not the baseline's size";
}

TEST(GloveConfig, RecordUsesWhatIsLearntWithAProtocolOfOnesOwn) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "own.toml", config_file = folder / "glove.json";
  testing::put(protocol,
               "rows = 2\ncols = 3\nbits = 10\nrate_hz = 25\nbaud = 9600\nstart = \"aa 55\"\n"
               "number_bytes = 1\n");
  GloveStream glove;
  glove.info = find_glove_protocol(protocol).usual_glove;
  std::string bytes;
  for (std::size_t i = 0; i < 120; ++i) {
    glove.sequence.push_back(i);
    for (int k = 0; k < 6; ++k)
      glove.counts.push_back(
          static_cast<std::uint16_t>(300 + i % 3 + (i < 60 ? 0 : 20 * (i % 10))));
    bytes += find_glove_protocol(protocol).encode(glove, i);
  }
  testing::put(folder / "glove.bin", bytes);
  const auto with_glove = [&](std::vector<std::string> arguments) {
    for (const std::string& word :
         {std::string("--glove"), (folder / "glove.bin").string(), std::string("--protocol"),
          protocol, std::string("--speed"), std::string("0")})
      arguments.push_back(word);
    return testing::run_touchtrace(arguments);
  };
  ASSERT_EQ(with_glove({"glove", "--learn", "--seconds", "1.5", "--output", config_file}), 0);
  EXPECT_EQ(read_glove_config(config_file).protocol, "own");
  EXPECT_EQ(with_glove({"record", "--glove-config", config_file, "--output", folder / "a.h5"}), 0);
}

TEST(GloveConfig, ALogKeepsTheBaseline) {
  SessionInfo session;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  session.glove = small_glove();
  EXPECT_TRUE(parse_session(to_bytes(session)).glove->baseline_counts.empty());
  session.glove->baseline_counts = {1, 2, 3, 4, 5, 6.5};
  EXPECT_EQ(parse_session(to_bytes(session)).glove->baseline_counts,
            session.glove->baseline_counts);
  session.glove->baseline_counts.pop_back();
  EXPECT_THROW(parse_session(to_bytes(session)), Error);
}

TEST(GloveConfig, LearningWritesIt) {
  const TemporaryFolder folder;
  GloveStream glove;
  glove.info = small_glove();
  RandomStream random(1, "learn");
  for (std::size_t i = 0; i < 120; ++i) {
    glove.sequence.push_back(i);
    for (int k = 0; k < 6; ++k)
      glove.counts.push_back(
          static_cast<std::uint16_t>(300 + random.below(4) + (i < 60 ? 0 : 20 * (i % 10))));
  }
  std::string bytes;
  for (std::size_t i = 0; i < 120; ++i) bytes += encode_mit_rows(glove, i);
  testing::put(folder / "glove.bin", bytes);
  const std::vector<std::string> learn{
      "glove",      "--learn",  "--glove",  (folder / "glove.bin").string(),
      "--protocol", "mit-rows", "--rows",   "2",
      "--cols",     "3",        "--bits",   "10",
      "--rate-hz",  "25",       "--speed",  "0",
      "--seconds",  "1.5",      "--output", (folder / "glove.json").string()};
  ASSERT_EQ(testing::run_touchtrace(learn), 0);
  const GloveConfig read = read_glove_config(folder / "glove.json");
  EXPECT_EQ(read.polarity, 1);
  EXPECT_EQ(read.protocol, "mit-rows");
  ASSERT_EQ(read.baseline_counts.size(), 6u);
  for (const float count : read.baseline_counts) EXPECT_NEAR(count, 301.5f, 1.5f);
  EXPECT_EQ(testing::run_touchtrace(learn), 2) << "the file exists";
}

}  // namespace
}  // namespace touchtrace
