#include <gtest/gtest.h>

#include <chrono>

#include "engine/base/crc32c.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/acquire/record/log.h"
#include "pipeline/acquire/record/session.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace touchtrace {
namespace {

using testing::TemporaryFolder;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::vector<std::string> payloads(LogReader& reader) {
  std::vector<std::string> all;
  while (const auto record = reader.next())
    all.emplace_back(record->payload.begin(), record->payload.end());
  return all;
}

/// Log of the records "0", "11", "222", ...; returns them.
std::vector<std::string> write_log(const std::filesystem::path& path, std::size_t records = 20) {
  LogWriter log(path);
  std::vector<std::string> all;
  for (std::size_t i = 0; i < records; ++i) {
    all.emplace_back(i + 1, static_cast<char>('0' + i));
    log.append(RecordKind::glove_frame, bytes_of(all.back()));
  }
  log.sync();
  return all;
}

TEST(Crc32c, HasTheValueOfTheStandard) {
  EXPECT_EQ(crc32c(bytes_of("123456789")), 0xe3069283u);
  EXPECT_EQ(crc32c(bytes_of("6789"), crc32c(bytes_of("12345"))), 0xe3069283u);
  EXPECT_EQ(crc32c(bytes_of(std::string(32, '\0'))), 0x8a9136aau);  // RFC 3720, B.4
}

TEST(RecordLog, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const auto written = write_log(folder / "a.log");
  LogReader reader(folder / "a.log");
  EXPECT_EQ(payloads(reader), written);
  EXPECT_EQ(reader.damage().torn_bytes, 0u);
  EXPECT_TRUE(reader.damage().is_torn_only());
}

TEST(RecordLog, CutsATornTailAtEveryLength) {
  const TemporaryFolder folder;
  const auto written = write_log(folder / "a.log", 5);
  const std::string whole = read_file(folder / "a.log");
  for (std::size_t size = 16 + 33; size < whole.size(); ++size) {
    testing::put(folder / "torn.log", whole.substr(0, size));
    LogReader reader(folder / "torn.log");
    const auto found = payloads(reader);
    EXPECT_LT(found.size(), written.size());
    EXPECT_TRUE(std::ranges::equal(found, std::span(written).first(found.size())));
    EXPECT_TRUE(reader.damage().is_torn_only());
    std::size_t read = 16;
    for (const auto& payload : found) read += 32 + payload.size();
    EXPECT_EQ(reader.damage().torn_bytes, size - read);
  }
}

TEST(RecordLog, NoFlippedBitIsSilentOrCostsMoreThanItsRecord) {
  const TemporaryFolder folder;
  const auto written = write_log(folder / "a.log", 5);
  std::string bytes = read_file(folder / "a.log");
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 3) {
    bytes[bit / 8] ^= static_cast<char>(1 << bit % 8);
    testing::put(folder / "flipped.log", bytes);
    bytes[bit / 8] ^= static_cast<char>(1 << bit % 8);
    LogReader reader(folder / "flipped.log");
    const auto found = payloads(reader);
    const LogDamage& damage = reader.damage();
    EXPECT_TRUE(damage.damaged_bytes > 0 || damage.torn_bytes > 0) << bit;
    EXPECT_GE(found.size(), written.size() - (bit < 128 ? 0 : 1)) << bit;
    for (const auto& payload : found) EXPECT_TRUE(std::ranges::count(written, payload)) << bit;
  }
}

TEST(RecordLog, RemovedRecordsAreCounted) {
  const TemporaryFolder folder;
  write_log(folder / "a.log", 3);
  const std::string bytes = read_file(folder / "a.log");
  testing::put(folder / "b.log", bytes.substr(0, 16 + 33) + bytes.substr(16 + 33 + 34));
  LogReader reader(folder / "b.log");
  EXPECT_EQ(payloads(reader).size(), 2u);
  EXPECT_EQ(reader.damage().lost_records, 1u);
}

TEST(RecordLog, RandomBytesAreRefusedOrSkipped) {
  const TemporaryFolder folder;
  write_log(folder / "a.log");
  const std::string good = read_file(folder / "a.log");
  RandomStream random(1, "random log");
  for (int i = 0; i < 300; ++i) {
    std::string bytes = good.substr(0, random.below(good.size()));
    for (std::uint64_t k = random.below(400); k > 0; --k)
      bytes.insert(random.below(bytes.size() + 1), 1, static_cast<char>(random.below(256)));
    testing::put(folder / "random.log", bytes);
    testing::expect_read_or_refused([&] {
      LogReader reader(folder / "random.log");
      payloads(reader);
    });
  }
}

TEST(RecordLog, ManyMarkersDoNotMakeItSlow) {
  const TemporaryFolder folder;
  write_log(folder / "a.log");
  std::string bytes = read_file(folder / "a.log");
  for (int i = 0; i < 1'000'000; ++i) bytes += "TCRD";
  testing::put(folder / "a.log", bytes);
  const auto start = std::chrono::steady_clock::now();
  LogReader reader(folder / "a.log");
  EXPECT_EQ(payloads(reader).size(), 20u);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

TEST(RecordLog, DoesNotReplaceALog) {
  const TemporaryFolder folder;
  write_log(folder / "a.log");
  EXPECT_THROW(LogWriter(folder / "a.log"), Error);
}

SessionInfo small_session() {
  SessionInfo session;
  session.glove.emplace();
  session.glove->rows = 2, session.glove->cols = 3;
  session.rest_s = 0.5;
  session.provenance = start_provenance("touchtrace/recording/2", "record");
  return session;
}

/// Log of such a session.
struct SmallLog : LogWriter {
  explicit SmallLog(const std::filesystem::path& path) : LogWriter(path) {
    append(RecordKind::description, to_bytes(small_session()));
  }
  void append_frame(std::uint64_t sequence) {
    const std::vector<std::uint16_t> counts(6, static_cast<std::uint16_t>(sequence % 1000));
    const double time_s = static_cast<double>(sequence) / 15.0;
    append(RecordKind::glove_frame,
           to_payload(FrameStamp{sequence, time_s, time_s}, std::span(counts)));
  }
};

TEST(RecordLog, AFullDiskKeepsWhatWasWritten) {
  const TemporaryFolder folder;
  const int code = testing::exit_code_on_small_disk(20'000, [&] {
    SmallLog log(folder / "a.log");
    for (std::uint64_t i = 0;; ++i) log.append_frame(i);
  });
  EXPECT_EQ(code, static_cast<int>(ExitCode::failed));
  const auto conversion = convert_log(folder / "a.log", folder / "a.h5", false);
  EXPECT_GT(conversion.glove_frames, 200u);
  EXPECT_EQ(conversion.lost_glove_frames, 0u);
  EXPECT_TRUE(conversion.is_complete());
  EXPECT_GT(conversion.damage.torn_bytes, 0u);
}

TEST(ConvertLog, EachConnectionIsAClip) {
  const TemporaryFolder folder;
  {
    SmallLog log(folder / "a.log");
    for (std::uint64_t i = 100; i < 130; ++i) log.append_frame(i);
    log.append(RecordKind::reconnection, {});
    for (std::uint64_t i = 200; i < 230; ++i) log.append_frame(i);
  }
  const auto conversion = convert_log(folder / "a.log", folder / "a.h5", false);
  EXPECT_EQ(conversion.glove_frames, 60u);
  EXPECT_EQ(conversion.lost_glove_frames, 0u);
  const RecordingReader reader(folder / "a.h5");
  const Recording& recording = reader.recording();
  ASSERT_EQ(recording.clips.size(), 2u);
  EXPECT_NEAR(recording.clips[0].end_s, 130.0 / 15.0, 1e-9);
  EXPECT_NEAR(recording.clips[1].start_s, 199.5 / 15.0, 1e-9);  // before its first frame arrived
  EXPECT_EQ(recording.gloves.at(0).sequence[30], 200u);
  EXPECT_EQ(recording.gloves.at(0).info.baseline_counts, std::vector<float>(6, 104.0f));
  EXPECT_NEAR(recording.gloves.at(0).info.rate_hz, 15.0, 1e-6);
}

TEST(ConvertLog, RecordsOfAnotherSizeOrOrderAreCounted) {
  const TemporaryFolder folder;
  {
    SmallLog log(folder / "a.log");
    for (const std::uint64_t i : {5u, 6u, 4u, 7u}) log.append_frame(i);
    log.append(RecordKind::glove_frame, bytes_of("too short"));
    log.append(RecordKind::color_image, bytes_of("no camera"));
    log.append(static_cast<RecordKind>(99), bytes_of("unknown"));
  }
  const auto conversion = convert_log(folder / "a.log", folder / "a.h5", false);
  EXPECT_EQ(conversion.glove_frames, 3u);
  EXPECT_EQ(conversion.unusable_records, 4u);
  EXPECT_FALSE(conversion.is_complete());
}

TEST(ConvertLog, ADamagedFirstDescriptionHasACopy) {
  const TemporaryFolder folder;
  {
    SmallLog log(folder / "a.log");
    log.append(RecordKind::description, to_bytes(small_session()));
    for (std::uint64_t i = 0; i < 5; ++i) log.append_frame(i);
  }
  std::string bytes = read_file(folder / "a.log");
  bytes[100] ^= 1;
  testing::put(folder / "a.log", bytes);
  EXPECT_EQ(convert_log(folder / "a.log", folder / "a.h5", false).glove_frames, 5u);
}

TEST(ConvertLog, ALogWithoutFramesIsAnError) {
  const TemporaryFolder folder;
  SmallLog(folder / "a.log");
  EXPECT_THROW(convert_log(folder / "a.log", folder / "a.h5", false), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  LogWriter(folder / "b.log").append(RecordKind::description, bytes_of("{\"rows\": -1}"));
  EXPECT_THROW(convert_log(folder / "b.log", folder / "a.h5", false), Error);
}

}  // namespace
}  // namespace touchtrace
