#include "pipeline/acquire/record/glove_config.h"

#include <gtest/gtest.h>

#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/session.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/command_line.h"
#include "tests/support/expect_error.h"

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
    const auto found =
        testing::expect_error([&] { read_glove_config(folder / "glove.json"); }, "glove.json");
    EXPECT_NE(found.find(fault), std::string::npos) << found;
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

/// Writes 120 frames of 2 x 3 taxels into the file "glove.bin": 60 at rest, 60 squeezed.
std::vector<std::uint16_t> write_frames(const TemporaryFolder& folder,
                                        const std::string& protocol = "mit-rows") {
  GloveStream glove;
  glove.info = small_glove();
  std::string bytes;
  for (std::size_t i = 0; i < 120; ++i) {
    glove.sequence.push_back(i);
    for (int k = 0; k < 6; ++k)
      glove.counts.push_back(
          static_cast<std::uint16_t>(300 + (i + k) % 4 + (i < 60 ? 0 : 20 * (i % 10))));
    bytes += find_glove_protocol(protocol).encode(glove, i);
  }
  testing::put(folder / "glove.bin", bytes);
  return glove.counts;
}

/// Runs a command with the options for "glove.bin".
int run_with_glove(const TemporaryFolder& folder, std::vector<std::string> arguments,
                   const std::string& protocol = "mit-rows") {
  const std::string file = folder / "glove.bin";
  arguments.insert(arguments.end(), {"--glove", file, "--protocol", protocol, "--speed", "0"});
  return testing::run_touchtrace(arguments);
}

TEST(GloveConfig, RecordUsesIt) {
  const TemporaryFolder folder;
  testing::put(folder / "glove.json", config().dump(2));
  const auto counts = write_frames(folder);
  const auto record = [&](std::vector<std::string> more, const char* protocol = "mit-rows") {
    more.insert(more.begin(), {"record", "--glove-config", folder / "glove.json", "--output",
                               folder / "a.h5", "--overwrite"});
    return run_with_glove(folder, more, protocol);
  };
  ASSERT_EQ(record({}), 0);
  const RecordingReader reader(folder / "a.h5");
  const GloveInfo& info = reader.recording().gloves.at(0).info;
  EXPECT_EQ(info.baseline_counts, (std::vector<float>{900, 901, 902.5, 903, 904, 1023}));
  EXPECT_EQ(info.polarity, -1);
  EXPECT_EQ(info.bits, 10);
  EXPECT_NEAR(info.rate_hz, 25.0, 1.0);
  EXPECT_EQ(reader.recording().gloves[0].counts, counts);
  EXPECT_LT(reader.recording().clips.at(0).start_s, reader.recording().gloves[0].host_time_s[0]);
  EXPECT_EQ(record({"--polarity", "1"}), 0) << "options come first";
  EXPECT_EQ(RecordingReader(folder / "a.h5").recording().gloves.at(0).info.polarity, 1);
  EXPECT_EQ(record({}, "stag"), 3) << "of another protocol";
  EXPECT_EQ(record({"--rows", "4"}), 2) << "not the baseline's size";
}

TEST(GloveConfig, RecordUsesWhatIsLearntWithAProtocolOfOnesOwn) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "own.toml", config_file = folder / "glove.json";
  testing::put(protocol,
               "rows = 2\ncols = 3\nbits = 10\nrate_hz = 25\nbaud = 9600\nstart = \"aa 55\"\n"
               "number_bytes = 1\n");
  write_frames(folder, protocol);
  const auto run = [&](const std::vector<std::string>& arguments) {
    return run_with_glove(folder, arguments, protocol);
  };
  ASSERT_EQ(run({"glove", "--learn", "--seconds", "1.5", "--output", config_file}), 0);
  EXPECT_EQ(read_glove_config(config_file).protocol, "own");
  EXPECT_EQ(run({"record", "--glove-config", config_file, "--output", folder / "a.h5"}), 0);
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
  write_frames(folder);
  const std::vector<std::string> learn{
      "glove", "--learn",   "--rows", "2",         "--cols", "3",        "--bits",
      "10",    "--rate-hz", "25",     "--seconds", "1.5",    "--output", folder / "glove.json"};
  ASSERT_EQ(run_with_glove(folder, learn), 0);
  const GloveConfig read = read_glove_config(folder / "glove.json");
  EXPECT_EQ(read.polarity, 1);
  EXPECT_EQ(read.protocol, "mit-rows");
  ASSERT_EQ(read.baseline_counts.size(), 6u);
  for (const float count : read.baseline_counts) EXPECT_NEAR(count, 301.5f, 1.5f);
  EXPECT_EQ(run_with_glove(folder, learn), 2) << "the file exists";
}

}  // namespace
}  // namespace touchtrace
