#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/import/bags/decompress.h"
#include "pipeline/export/byte_writer.h"
#include "pipeline/export/export.h"
#include "pipeline/export/mcap_writer.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::run_script;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.substr(at, sizeof number).data(), sizeof number);
  return number;
}

struct Record {
  std::uint8_t opcode;
  std::uint64_t at;  ///< position in the file
  std::string content;
};

std::vector<Record> records_of(const std::string& bytes, std::size_t at, std::size_t end) {
  std::vector<Record> records;
  while (at < end) {
    const auto size = number_at<std::uint64_t>(bytes, at + 1);
    records.push_back({static_cast<std::uint8_t>(bytes[at]), at, bytes.substr(at + 9, size)});
    at += 9 + size;
  }
  EXPECT_EQ(at, end);
  return records;
}

std::string unpacked(const std::string& frame, std::size_t size) {
  const std::vector<std::uint8_t> stored(frame.begin(), frame.end());
  const auto bytes = decompress(Compression::lz4, stored, size);
  return {bytes.begin(), bytes.end()};
}

TEST(Crc32, IsThatOfZip) { EXPECT_EQ(crc32("123456789"), 0xcbf43926u); }

/// Structure as mcap.dev/spec describes it.
TEST(McapWriter, WritesRecordsIndicesAndChecksums) {
  const TemporaryFolder folder;
  McapWriter writer(folder / "a.mcap", "ros2");
  const auto schema = writer.add_schema("pkg/msg/T", "ros2msg", "uint8 x\n");
  const auto a = writer.add_channel(schema, "/a", "cdr"),
             b = writer.add_channel(schema, "/b", "cdr");
  writer.write(a, 5, "one"), writer.write(b, 7, "two"), writer.write(a, 9, "three");
  writer.finish();
  const std::string bytes = read_file(folder / "a.mcap"), magic = "\x89MCAP0\r\n";
  ASSERT_EQ(bytes.substr(0, 8), magic);
  ASSERT_EQ(bytes.substr(bytes.size() - 8), magic);
  const auto records = records_of(bytes, 8, bytes.size() - 8);
  std::string opcodes;
  for (const Record& record : records) opcodes += fmt::format("{:x} ", record.opcode);
  EXPECT_EQ(opcodes, "1 3 4 4 6 7 7 f 3 4 4 b 8 e e e e 2 ");

  const std::string& chunk = records[4].content;
  EXPECT_EQ(number_at<std::uint64_t>(chunk, 0), 5u);
  EXPECT_EQ(number_at<std::uint64_t>(chunk, 8), 9u);
  EXPECT_EQ(chunk.substr(28, 7), std::string("\3\0\0\0lz4", 7));
  const auto packed = number_at<std::uint64_t>(chunk, 35);
  ASSERT_EQ(43 + packed, chunk.size());
  const std::string messages = unpacked(chunk.substr(43), number_at<std::uint64_t>(chunk, 16));
  EXPECT_EQ(number_at<std::uint32_t>(chunk, 24), crc32(messages));
  const auto inner = records_of(messages, 0, messages.size());
  ASSERT_EQ(inner.size(), 3u);
  EXPECT_EQ(inner[2].content.substr(22), "three");
  EXPECT_EQ(number_at<std::uint32_t>(inner[2].content, 2), 1u) << "sequence in the channel";
  EXPECT_EQ(number_at<std::uint64_t>(inner[2].content, 6), 9u);

  const std::string& index = records[5].content;  // of channel a: two times and offsets
  EXPECT_EQ(number_at<std::uint32_t>(index, 2), 32u);
  EXPECT_EQ(number_at<std::uint64_t>(index, 22), 9u);
  EXPECT_EQ(number_at<std::uint64_t>(index, 30), inner[2].at);

  const Record &data_end = records[7], &footer = records.back();
  EXPECT_EQ(number_at<std::uint32_t>(data_end.content, 0), crc32(bytes.substr(0, data_end.at)));
  EXPECT_EQ(number_at<std::uint64_t>(footer.content, 0), records[8].at) << "start of the summary";
  EXPECT_EQ(number_at<std::uint64_t>(footer.content, 8), records[13].at);
  EXPECT_EQ(
      number_at<std::uint32_t>(footer.content, 16),
      crc32(std::string_view(bytes).substr(records[8].at, footer.at + 9 + 16 - records[8].at)));
  const std::string& chunk_index = records[12].content;
  EXPECT_EQ(number_at<std::uint64_t>(chunk_index, 16), records[4].at);
  EXPECT_EQ(number_at<std::uint64_t>(chunk_index, 24), records[5].at - records[4].at);
}

TEST(McapWriter, StartsANewChunkBeyondFourMebibytes) {
  const TemporaryFolder folder;
  McapWriter writer(folder / "a.mcap", "");
  const auto channel = writer.add_channel(writer.add_schema("T", "ros2msg", ""), "/a", "cdr");
  const std::string big(3u << 20, 'x');
  for (std::uint64_t i = 0; i < 4; ++i) writer.write(channel, i, big);
  writer.finish();
  const std::string bytes = read_file(folder / "a.mcap");
  int chunks = 0;
  for (const Record& record : records_of(bytes, 8, bytes.size() - 8)) chunks += record.opcode == 6;
  EXPECT_EQ(chunks, 2);
}

/// Sample files, and their export as MCAP.
struct McapFiles {
  McapFiles() {
    auto sample = sample_recording();
    sample.recording.camera.color_camera = Camera{8, 6, 7.5, 7.25, 4.0, 3.0};
    write(sample, folder / "r.h5");
    auto labels = sample_labels(sample.recording);
    labels.hand.quality[3] = quality_lost;
    write_labels(folder / "l.h5", labels, false);
  }
  ExportRequest request(const char* output) const {
    return {FileKind::labels, folder / "l.h5", folder / output, folder / "r.h5", true};
  }
  TemporaryFolder folder;
};

TEST(Mcap, OfficialReaderReadsLabelsTouchAndImages) {
  SKIP_WITHOUT_MODULES("mcap_ros2, h5py");
  const McapFiles files;
  export_file("mcap", files.request("a.mcap"));
  const auto result = run_script(
      "read_mcap.py", fmt::format("{0}/a.mcap {0}/l.h5 {0}/r.h5", files.folder.path().string()));
  EXPECT_EQ(result.status, 0) << result.output;
}

TEST(Rosbag2, RosbagsReadsTheFolder) {
  SKIP_WITHOUT_MODULES("rosbags, h5py");
  const McapFiles files;
  export_file("rosbag2", files.request("bag"));
  const auto result =
      run_script("read_rosbag2.py", fmt::format("{0}/bag {0}/l.h5", files.folder.path().string()));
  EXPECT_EQ(result.status, 0) << result.output;
}

TEST(Rosbag2, MetadataNamesTheFileAndItsTopics) {
  const McapFiles files;
  export_file("rosbag2", files.request("bag"));
  const std::string text = read_file(files.folder / "bag/metadata.yaml");
  EXPECT_NE(text.find("name: /hand/odometry\n        type: nav_msgs/msg/Odometry\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("relative_file_paths:\n    - messages.mcap\n"), std::string::npos);
  // 2 (39 hands + 40 objects), 38 glove frames, 54 pairs of images with 2 camera_info each.
  EXPECT_NE(text.find("  message_count: 412\n  topics"), std::string::npos) << text;
}

TEST(Mcap, LabelsAloneHaveNoNegativeStamps) {
  const TemporaryFolder folder;
  auto labels = sample_labels(sample_recording().recording);
  for (double& time_s : labels.time_s) time_s -= 12.5;  // the first label is at -2.5 s
  write_labels(folder / "l.h5", labels, false);
  export_file("mcap", {FileKind::labels, folder / "l.h5", folder / "a.mcap"});
  const std::string bytes = read_file(folder / "a.mcap");
  for (const Record& record : records_of(bytes, 8, bytes.size() - 8))
    if (record.opcode == 6) {
      EXPECT_EQ(number_at<std::uint64_t>(record.content, 0), 500'000'000u);
    }
}

}  // namespace
}  // namespace touchtrace
