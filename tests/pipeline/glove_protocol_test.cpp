#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <map>

#include "engine/base/files.h"
#include "pipeline/acquire/glove/own_protocol.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/command_line.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using namespace std::string_literals;
using testing::TemporaryFolder;

const std::string own_protocols = TOUCHTRACE_SOURCE_DIR "/tests/data/gloves/";

std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.substr(at, size).data(), size);
  return value;
}

GloveStream two_by_two(int bits, std::vector<std::uint16_t> counts, std::uint64_t sequence) {
  GloveStream glove;
  glove.info.rows = glove.info.cols = 2;
  glove.info.bits = bits;
  glove.sequence = {sequence};
  glove.counts = std::move(counts);
  return glove;
}

std::string encode_all(const GloveStream& glove, const std::string& protocol) {
  std::string bytes;
  for (std::size_t frame = 0; frame < glove.frames(); ++frame)
    bytes += find_glove_protocol(protocol).encode(glove, frame);
  return bytes;
}

/// 40 frames of 30 taxels; two frames are lost.
GloveStream sample() {
  RandomStream random(3, "glove protocol");
  return testing::sample_glove(40, 0.0, random);
}

TEST(GloveProtocol, ActionSenseSplitsTenBitsIntoFives) {
  EXPECT_EQ(encode_all(two_by_two(10, {0, 31, 32, 1023}, 244), "actionsense"),
            "\x0b\x0b\x0b\x0b\x2a\x0c\x0b\x2a\x2a\n"s);
}

TEST(GloveProtocol, ActionSenseSplitsTwelveBitsIntoSixes) {
  EXPECT_EQ(encode_all(two_by_two(12, {0, 63, 64, 4095}, 243), "actionsense"),
            "\xfe\x0b\x0b\x0b\x4a\x0c\x0b\x4a\x4a\n"s);
}

TEST(GloveProtocol, ActionSenseDataContainNoNewline) {
  std::vector<std::uint16_t> all(4096);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
  GloveStream glove = two_by_two(12, std::move(all), 0);
  glove.info.rows = glove.info.cols = 64;
  const std::string bytes = encode_all(glove, "actionsense");
  EXPECT_EQ(bytes.find('\n'), bytes.size() - 1);
}

TEST(GloveProtocol, MitRowsHaveRowNumberAndEndMarker) {
  EXPECT_EQ(encode_all(two_by_two(12, {1, 2, 0x0ff3, 4}, 9), "mit-rows"),
            "\0\0\1\0\2\0wr\0\1\xf3\x0f\4\0wr"s);
}

TEST(GloveProtocol, StagSendsText) {
  EXPECT_EQ(encode_all(two_by_two(12, {1500, 0, 27, 4095}, 9), "stag"), "1500\t0\t27\t4095\n");
}

TEST(GloveProtocol, VitacEndsAFrameWithABlankLine) {
  EXPECT_EQ(encode_all(two_by_two(8, {1, 0, 27, 255}, 9), "vitac"), "1 0\n27 255\n\n");
}

TEST(GloveProtocol, Jq20SendsTwoPackets) {
  std::vector<std::uint16_t> counts(256, 3);
  counts[128] = 0xfe;
  GloveStream glove = two_by_two(8, std::move(counts), 0);
  glove.info.rows = glove.info.cols = 16;
  const std::string bytes = encode_all(glove, "jq20");
  ASSERT_EQ(bytes.size(), 134u + 150u);
  EXPECT_EQ(bytes.substr(0, 7), "\xaa\x55\x03\x99\1\1\3"s);
  EXPECT_EQ(bytes.substr(134, 7), "\xaa\x55\x03\x99\2\1\xfe"s);
}

/// Decodes packets of 249 bytes: counts by their index since the device started.
std::map<std::uint64_t, std::uint64_t> packets_read(const std::string& bytes,
                                                    std::uint64_t taxels) {
  std::map<std::uint64_t, std::uint64_t> counts;
  EXPECT_EQ(bytes.size() % 249, 0u);
  for (std::size_t at = 0; at < bytes.size(); at += 249) {
    const std::uint64_t first = 120 * number(bytes, at + 243, 4);
    EXPECT_EQ(bytes[at], 0);
    EXPECT_EQ(number(bytes, at + 1, 2), first % taxels);
    EXPECT_EQ(bytes.substr(at + 247, 2), "wr");
    for (std::size_t i = 0; i < 120; ++i)
      EXPECT_TRUE(counts.emplace(first + i, number(bytes, at + 3 + 2 * i, 2)).second);
  }
  return counts;
}

TEST(GloveProtocol, WiReSensPacketsCrossFrames) {
  const GloveStream glove = sample();
  const auto read = packets_read(encode_all(glove, "wiresens"), 30);
  for (std::size_t frame = 0; frame < glove.frames(); ++frame)
    for (std::uint64_t taxel = 0; taxel < 30; ++taxel) {
      const auto found = read.find(30 * glove.sequence[frame] + taxel);
      if (found == read.end()) continue;
      EXPECT_EQ(found->second, glove.counts[30 * frame + taxel]);
    }
  // Frames 1000 to 1039 are ten packets of four frames; those with 1007 and 1027 are lost.
  EXPECT_EQ(read.size(), 8u * 120u);
  for (const std::uint64_t lost : {1007u, 1027u}) EXPECT_FALSE(read.contains(30 * lost));
}

TEST(GloveProtocol, RejectsCountsWithTooManyBits) {
  GloveInfo info;
  info.bits = 16;
  EXPECT_THROW(require_supported(find_glove_protocol("actionsense"), info), Error);
  EXPECT_NO_THROW(require_supported(find_glove_protocol("wiresens"), info));
  EXPECT_THROW(find_glove_protocol("morse"), Error);
  info.bits = 8;
  EXPECT_THROW(require_supported(find_glove_protocol("jq20"), info), Error);  // 32 x 32 taxels
  info.bits = 12;
  EXPECT_NO_THROW(require_supported(find_glove_protocol("vitac"), info));
}

int send(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "send");
  return testing::run_touchtrace(std::move(arguments));
}

TEST(SendCommand, WritesTheBytesOfTheDevice) {
  const TemporaryFolder folder;
  const auto recording = testing::sample_recording();
  testing::write(recording, folder / "a.h5");
  const std::string file = (folder / "a.h5").string(), output = (folder / "a.bin").string();
  for (const std::string protocol : {"actionsense", "mit-rows", "wiresens", "stag"}) {
    ASSERT_EQ(send({file, "--protocol", protocol, "--output", output, "--overwrite"}), 0);
    EXPECT_EQ(read_file(output), encode_all(recording.recording.gloves[0], protocol)) << protocol;
  }
}

TEST(SendCommand, LiveSendsFramesAtTheirTimes) {
  const TemporaryFolder folder;
  const auto sample = testing::sample_recording(5);
  testing::write(sample, folder / "a.h5");
  const auto& glove = sample.recording.gloves[0];
  ::testing::internal::CaptureStdout();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(send({(folder / "a.h5").string(), "--live", "--protocol", "stag"}), 0);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), encode_all(glove, "stag"));
  EXPECT_GE(took.count(), glove.host_time_s.back() - glove.host_time_s.front());
}

TEST(SendCommand, InvalidUseHasExitCode) {
  const TemporaryFolder folder;
  testing::write(testing::sample_recording(), folder / "a.h5");
  const std::string file = (folder / "a.h5").string(), output = (folder / "a.bin").string();
  EXPECT_EQ(send({file, "--json"}), 2);
  EXPECT_EQ(send({file, "--live", "--output", output}), 2);
  EXPECT_EQ(send({file, "--protocol", "morse", "--output", output}), 2);
  EXPECT_EQ(send({(folder / "none.h5").string(), "--output", output}), 3);
  ASSERT_EQ(send({file, "--output", output}), 0);
  EXPECT_NE(send({file, "--output", output}), 0);  // output exists
}

TEST(OwnGloveProtocol, PacketHasTheDescribedPlaces) {
  GloveStream glove;
  glove.info = find_glove_protocol(own_protocols + "numbered.toml").usual_glove;
  glove.sequence = {0x1234};
  for (int i = 0; i < 96; ++i) glove.counts.push_back(static_cast<std::uint16_t>(256 + i));
  const std::string packet = find_glove_protocol(own_protocols + "numbered.toml").encode(glove, 0);
  ASSERT_EQ(packet.size(), 2u + 2u + 192u + 2u);
  EXPECT_EQ(packet.substr(0, 6), std::string("\xaa\x55\x12\x34\x01\x00", 6));
  EXPECT_EQ(packet.substr(6, 2), "\x01\x06") << "the column goes on: row 1 of 6 columns";
  EXPECT_EQ(packet.substr(196), "\r\n");
}

TEST(OwnGloveProtocol, AChangedByteIsTorn) {
  const GloveProtocol& protocol = find_glove_protocol(own_protocols + "summed.toml");
  GloveStream glove;
  glove.info = protocol.usual_glove;
  std::string bytes;
  for (std::size_t frame = 0; frame < 6; ++frame) {
    glove.sequence.push_back(frame);
    for (int i = 0; i < 96; ++i) glove.counts.push_back(static_cast<std::uint16_t>(256 + i));
    bytes += protocol.encode(glove, frame);
  }
  ASSERT_EQ(bytes.size(), 6u * 199u);
  bytes[2 * 199 + 50] ^= 1;  // a count of the third frame
  std::vector<std::uint64_t> numbers;
  const auto parser = protocol.parse(
      glove.info, [&](const GloveFrame& frame) { numbers.push_back(frame.sequence); });
  parser->feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, 0.0);
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{0, 1, 3, 4, 5}));
  EXPECT_EQ(parser->counts().torn, 1u);
}

TEST(OwnGloveProtocol, InvalidFilesAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "own.toml";
  const std::string valid = read_file(own_protocols + "numbered.toml");
  const auto read_changed = [&](const std::string& from, const std::string& to) {
    std::string text = valid;
    write_file(file, text.replace(text.find(from), from.size(), to), true);
    return read_glove_protocol(file);
  };
  EXPECT_NO_THROW(read_changed("rows = 16", "rows = 16"));
  for (const auto& [from, to, fault] :
       {std::array{"rows = 16", "rows = 0", "rows is 0"},
        {"rows = 16", "rows = 1.5", "not a whole number"},
        {"rows = 16", "rows = 1666666666666666666", "rows is 1.66667e+18"},
        {"start = \"aa 55\"", "start = \"aa 5\"", "hexadecimal"},
        {"start = \"aa 55\"", "", "start is missing"},
        {"bits = 12", "bits = 12\ncount_bytes = 1", "count_bytes is too small"},
        {"bits = 12", "bits = 12\nlength = 100", "of a packet of 100"},
        {"bits = 12", "bits = 12\nnumber_at = 5", "number_at puts the number"},
        {"bits = 12", "bits = 12\nchecksum = \"crc\"", "checksum"},
        {"bits = 12", "bits = 12\nchecksum = \"xor8\"\nlength = 198", "counts_at"}})
    testing::expect_error([&] { read_changed(from, to); }, fault, {});
  try {
    read_changed("bits = 12", "bits = 12\nheader = 1");
    ADD_FAILURE() << "accepted an unknown key";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("unknown key 'header'"), std::string::npos);
    EXPECT_EQ(error.hint().find("polarity"), error.hint().rfind("polarity")) << "named twice";
  }
  EXPECT_THROW(find_glove_protocol(folder / "missing.toml"), Error);
}

}  // namespace
}  // namespace touchtrace
