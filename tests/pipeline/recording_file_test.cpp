#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

/// Compares bits, so that NaN equals itself.
template <class T>
::testing::AssertionResult same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  if (std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b))))
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << a.size() << " and " << b.size() << " values differ";
}

void expect_same(const GloveStream& a, const GloveStream& b) {
  EXPECT_EQ(a.info.name, b.info.name);
  EXPECT_EQ(a.info.rows, b.info.rows);
  EXPECT_EQ(a.info.cols, b.info.cols);
  EXPECT_EQ(a.info.rate_hz, b.info.rate_hz);
  EXPECT_EQ(a.info.scan_s, b.info.scan_s);
  EXPECT_EQ(a.info.bits, b.info.bits);
  EXPECT_EQ(a.info.polarity, b.info.polarity);
  EXPECT_TRUE(same_bits(a.info.baseline_counts, b.info.baseline_counts));
  EXPECT_TRUE(same_bits(a.info.mask, b.info.mask));
  EXPECT_TRUE(same_bits(a.info.taxel_position_m, b.info.taxel_position_m));
  EXPECT_TRUE(same_bits(a.sequence, b.sequence));
  EXPECT_TRUE(same_bits(a.host_time_s, b.host_time_s));
  EXPECT_TRUE(same_bits(a.counts, b.counts));
}

void expect_same(const RgbdFrame& a, const RgbdFrame& b) {
  EXPECT_TRUE(same_bits(a.color, b.color));
  EXPECT_TRUE(same_bits(a.depth, b.depth));
  EXPECT_TRUE(same_bits(a.mask, b.mask));
}

TEST(RecordingFile, RoundTripsEveryBit) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  sample.recording.gloves.push_back(sample.recording.gloves[0]);
  sample.recording.gloves[1].info.name = "left";
  sample.recording.gloves[1].info.polarity = -1;
  sample.recording.clips[1].box_frame = 52;
  write(sample, folder / "a.h5");
  const RecordingReader reader(folder / "a.h5");
  const Recording& back = reader.recording();
  EXPECT_EQ(back.activity, sample.recording.activity);
  EXPECT_EQ(back.epoch_unix_s, sample.recording.epoch_unix_s);
  EXPECT_EQ(back.provenance.options, sample.recording.provenance.options);
  EXPECT_EQ(back.board.square_m, sample.recording.board.square_m);
  EXPECT_EQ(back.camera.gravity_m_per_s2, sample.recording.camera.gravity_m_per_s2);
  EXPECT_EQ(back.camera.depth_camera->parameters(),
            sample.recording.camera.depth_camera->parameters());
  EXPECT_EQ(back.camera.depth_unit_m, sample.recording.camera.depth_unit_m);
  EXPECT_EQ(back.clips, sample.recording.clips);
  ASSERT_EQ(back.gloves.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) expect_same(back.gloves[i], sample.recording.gloves[i]);
  EXPECT_TRUE(same_bits(back.camera_times.host_time_s, sample.recording.camera_times.host_time_s));
  EXPECT_TRUE(
      same_bits(back.camera_times.device_time_s, sample.recording.camera_times.device_time_s));
  EXPECT_TRUE(reader.has_depth());
  for (std::size_t i = 0; i < sample.frames.size(); ++i)
    expect_same(reader.read_camera_frame(i), sample.frames[i]);
  ASSERT_EQ(reader.background_frames(), 1u);
  expect_same(reader.read_background(0), sample.background[0]);
  ASSERT_EQ(reader.board_views(), 2u);
  expect_same(reader.read_board_view(1), sample.board[1]);
}

TEST(RecordingFile, WritesEqualBytesForEqualContent) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  std::this_thread::sleep_for(
      std::chrono::milliseconds(1100));  // HDF5 time stamps have a resolution of 1 s
  write(sample, folder / "b.h5");
  EXPECT_EQ(sha256_of_file(folder / "a.h5"), sha256_of_file(folder / "b.h5"));
}

TEST(RecordingFile, RoundTripsTruthIfWritten) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  const Truth back = read_truth(folder / "a.h5");
  EXPECT_TRUE(same_bits(back.time_s, sample.truth.time_s));
  EXPECT_TRUE(same_bits(back.clip, sample.truth.clip));
  EXPECT_TRUE(same_bits(back.object.position_m, sample.truth.object.position_m));
  EXPECT_TRUE(same_bits(back.hand.velocity_m_per_s, sample.truth.hand.velocity_m_per_s));
  EXPECT_TRUE(same_bits(back.hand.orientation_wxyz, sample.truth.hand.orientation_wxyz));
  EXPECT_TRUE(same_bits(back.contact_force_n, sample.truth.contact_force_n));
  ASSERT_EQ(back.events.size(), 2u);
  EXPECT_EQ(back.events[1].kind, "catch");
  EXPECT_EQ(back.clocks, sample.truth.clocks);
  write(sample, folder / "without.h5", false);
  EXPECT_THROW(read_truth(folder / "without.h5"), Error);
}

TEST(RecordingFile, RoundTripsLabels) {
  const TemporaryFolder folder;
  const Labels labels = sample_labels(sample_recording().recording);
  write_labels(folder / "l.h5", labels, false);
  const Labels back = read_labels(folder / "l.h5");
  EXPECT_EQ(back.activity, labels.activity);
  EXPECT_EQ(back.summary, labels.summary);
  EXPECT_EQ(back.clips, labels.clips);
  EXPECT_TRUE(same_bits(back.time_s, labels.time_s));
  EXPECT_TRUE(same_bits(back.clip, labels.clip));
  EXPECT_TRUE(same_bits(back.glove_frame, labels.glove_frame));
  EXPECT_TRUE(same_bits(back.object.covariance, labels.object.covariance));
  EXPECT_TRUE(same_bits(back.object.position_m, labels.object.position_m));
  EXPECT_TRUE(same_bits(back.hand.causal_velocity_m_per_s, labels.hand.causal_velocity_m_per_s));
  EXPECT_TRUE(same_bits(back.hand.quality, labels.hand.quality));
  EXPECT_TRUE(same_bits(back.raw.object_m, labels.raw.object_m));
  EXPECT_TRUE(same_bits(back.object.error_budget_m, labels.object.error_budget_m));
  EXPECT_EQ(back.contact_sheet_jpeg, labels.contact_sheet_jpeg);
}

TEST(RecordingFile, AcceptsGloveOnlyAndBoardOnlyRecordings) {
  const TemporaryFolder folder;
  auto touch_only = sample_recording();
  touch_only.recording.camera = {};
  touch_only.recording.camera_times = {};
  touch_only.frames.clear(), touch_only.background.clear(), touch_only.board.clear();
  write(touch_only, folder / "touch.h5");
  const RecordingReader touch(folder / "touch.h5");
  EXPECT_FALSE(touch.has_depth());
  EXPECT_EQ(touch.board_views(), 0u);
  EXPECT_THROW(touch.read_camera_frame(0), Error);

  auto board_only = sample_recording();
  board_only.recording.clips.clear(), board_only.recording.gloves.clear();
  board_only.recording.camera_times = {};
  board_only.frames.clear();
  write(board_only, folder / "board.h5", false);
  EXPECT_EQ(RecordingReader(folder / "board.h5").board_views(), 2u);
}

TEST(RecordingFile, AcceptsRecordingsWithoutDepth) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  for (auto* images : {&sample.frames, &sample.background, &sample.board})
    for (auto& frame : *images) frame.depth.clear();
  write(sample, folder / "a.h5");
  const RecordingReader reader(folder / "a.h5");
  EXPECT_FALSE(reader.has_depth());
  expect_same(reader.read_camera_frame(3), sample.frames[3]);
}

TEST(RecordingFile, ReadsImagesFromSeveralThreads) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  const RecordingReader reader(folder / "a.h5");
  std::vector<std::jthread> threads;
  std::atomic<int> wrong = 0;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([&] {
      for (std::size_t i = 0; i < sample.frames.size(); ++i)
        if (reader.read_camera_frame(i).color != sample.frames[i].color) ++wrong;
    });
  threads.clear();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace touchtrace
