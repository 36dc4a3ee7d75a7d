#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/stream_check.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::SampleRecording;
using testing::TemporaryFolder;

FileCheck check_sample(const SampleRecording& sample) {
  const TemporaryFolder folder;
  write(sample, folder / "a.h5");
  return check_file(folder / "a.h5", true, true);
}

std::string expect_file_fault(const std::filesystem::path& path, const std::string& fault) {
  return testing::expect_error([&] { check_file(path, true); }, fault);
}

/// Expects that a recording has the fault after `modify` changed it. Returns the message.
template <class Modify>
std::string expect_fault(const std::string& fault, const Modify& modify) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  modify(sample);
  write(sample, folder / "a.h5");
  return expect_file_fault(folder / "a.h5", fault);
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Check, DescribesAValidRecording) {
  const FileCheck check = check_sample(sample_recording());
  EXPECT_TRUE(check.is_usable());
  for (const char* command : {"label", "train"})
    EXPECT_TRUE(check.missing.at(command).empty()) << command;
  EXPECT_EQ(check.missing.at("calibrate").size(), 1u);  // two views of the board are too few
  const auto& glove = check.contents.at("gloves").at(0);
  EXPECT_EQ(glove.at("frames"), 38);
  EXPECT_EQ(glove.at("lost"), 2);
  EXPECT_EQ(glove.at("taxels"), 29);
  EXPECT_EQ(glove.at("dead_taxels"), 0);
  // Uniform jitter of 1 ms has a standard deviation of 1 / sqrt(12) ms. Its estimate from 38 frames
  // has a relative standard error below 1 / sqrt(2 * 38) = 0.11; the tolerance is over 4 times
  // that.
  EXPECT_NEAR(glove.at("jitter_s").get<double>(), 1e-3 / std::sqrt(12.0), 0.5e-3 / std::sqrt(12.0));
  EXPECT_NEAR(glove.at("rate_hz").get<double>(), 15.0, 0.05);
  EXPECT_EQ(check.contents.at("clips").at("objects").at("ball"), 1);
  EXPECT_EQ(check.contents.at("truth"), true);
}

TEST(Check, TimingComesFromCounterAndClock) {
  const std::vector<std::uint64_t> sequence{10, 11, 13, 14, 20};
  std::vector<double> time_s;
  for (auto number : sequence) time_s.push_back(100.0 + 0.05 * static_cast<double>(number));
  const StreamTiming timing = measure_stream_timing(sequence, time_s, {});
  EXPECT_EQ(timing.lost, 6u);
  EXPECT_NEAR(timing.rate_hz, 20.0, 1e-9);
  EXPECT_NEAR(timing.jitter_s, 0.0, 1e-7);
  EXPECT_TRUE(std::isnan(measure_stream_timing({1, 2}, {0.0, 1.0}, {}).rate_hz));
}

TEST(Check, ListsWhatEachCommandNeeds) {
  auto no_glove = sample_recording();
  no_glove.recording.gloves.clear();
  no_glove.board.push_back(no_glove.board[0]);
  FileCheck check = check_sample(no_glove);
  EXPECT_TRUE(check.is_usable());
  EXPECT_TRUE(check.missing.at("calibrate").empty());
  EXPECT_TRUE(check.missing.at("label").empty());
  EXPECT_EQ(check.missing.at("train"), std::vector<std::string>{"no glove"});

  auto no_depth = sample_recording();
  for (auto* images : {&no_depth.frames, &no_depth.background, &no_depth.board})
    for (auto& frame : *images) frame.depth.clear();
  check = check_sample(no_depth);
  EXPECT_EQ(check.missing.at("label"), std::vector<std::string>{"no depth images"});

  auto all_fell = sample_recording();
  for (auto& clip : all_fell.recording.clips) clip.object_fell = true;
  EXPECT_FALSE(check_sample(all_fell).is_usable());
}

TEST(Check, SingleFrameIsReadableButUnusable) {
  auto sample = sample_recording();
  auto& glove = sample.recording.gloves[0];
  glove.sequence.resize(1), glove.host_time_s.resize(1), glove.counts.resize(30);
  auto& times = sample.recording.camera_times;
  times.sequence.resize(1), times.host_time_s.resize(1), times.device_time_s.resize(1);
  sample.frames.resize(1);
  const FileCheck check = check_sample(sample);
  EXPECT_FALSE(check.is_usable());
  EXPECT_EQ(check.missing.at("label").size(), 1u);
}

TEST(Check, FindsZeroSaturatedAndConstantGloves) {
  const auto with_counts = [](int polarity, std::uint16_t counts) {
    auto sample = sample_recording();
    sample.recording.gloves[0].info.polarity = polarity;
    std::ranges::fill(sample.recording.gloves[0].counts, counts);
    return check_sample(sample);
  };
  EXPECT_TRUE(mentions(with_counts(1, 0).faults.at(0), "all zero"));
  EXPECT_TRUE(mentions(with_counts(1, 1023).faults.at(0), "saturated"));
  EXPECT_TRUE(mentions(with_counts(-1, 0).faults.at(1), "saturated"));
  EXPECT_TRUE(mentions(with_counts(1, 300).faults.at(0), "constant counts"));
  EXPECT_FALSE(with_counts(1, 300).is_usable());
}

TEST(Check, RejectsTimesThatRunBackward) {
  auto sample = sample_recording();
  sample.recording.gloves[0].host_time_s[5] = sample.recording.gloves[0].host_time_s[4];
  EXPECT_TRUE(check_sample(sample).is_usable());  // two frames arrived at once
  expect_fault("/glove0/host_time_s: expected times that do not run backward", [](auto& sample) {
    auto& time_s = sample.recording.gloves[0].host_time_s;
    time_s[5] = time_s[4] - 1e-3;
  });
  expect_fault("/color/host_time_s",
               [](auto& sample) { sample.recording.camera_times.host_time_s[9] = 0.0; });
  expect_fault("/glove0/sequence", [](auto& sample) {
    auto& sequence = sample.recording.gloves[0].sequence;
    std::swap(sequence[2], sequence[3]);
  });
  expect_fault("clip 1: starts at 10 s, before the previous clip ends", [](auto& sample) {
    std::swap(sample.recording.clips[0], sample.recording.clips[1]);
  });
}

TEST(Check, RejectsNaNAndInfinity) {
  const double nan = std::nan("");
  expect_fault("/color/device_time_s: expected finite values, found nan at index 3",
               [&](auto& sample) { sample.recording.camera_times.device_time_s[3] = nan; });
  expect_fault("/glove0/baseline: expected finite values, found inf at index 7", [](auto& sample) {
    sample.recording.gloves[0].info.baseline_counts[7] = std::numeric_limits<float>::infinity();
  });
  expect_fault("/clips, clip 0: expected start_s < end_s",
               [&](auto& sample) { sample.recording.clips[0].end_s = nan; });
  auto sample = sample_recording();
  sample.truth.object.position_m[1] = nan;
  const TemporaryFolder folder;
  write(sample, folder / "a.h5");
  expect_file_fault(folder / "a.h5", "/truth/object/position_m");
  EXPECT_THROW(read_truth(folder / "a.h5"), Error);
}

TEST(Check, RejectsAttributesOutOfRange) {
  expect_fault("/glove0/counts: expected at most 255 (8 bits)",
               [](auto& sample) { sample.recording.gloves[0].info.bits = 8; });
  expect_fault("/glove0 attribute 'rate_hz'",
               [](auto& sample) { sample.recording.gloves[0].info.rate_hz = 0.0; });
  expect_fault("/glove0/mask: expected a taxel",
               [](auto& sample) { sample.recording.gloves[0].info.mask.assign(30, 0); });
  expect_fault("/board attribute 'square_m'",
               [](auto& sample) { sample.recording.board.square_m = 0.0; });
}

TEST(Check, ListsAllFaultsOfAFileAtOnce) {
  const auto fault = expect_fault(": 8 faults\n", [](auto& sample) {
    Recording& recording = sample.recording;
    recording.clips[1].end_s = recording.clips[1].start_s;
    recording.gloves[0].info.polarity = 3;
    recording.gloves[0].info.mask[2] = 9;
    recording.gloves[0].host_time_s[5] = std::nan("");
    recording.camera_times.sequence[2] = recording.camera_times.sequence[1];
    recording.board.columns = 1;
    sample.truth.time_s[1] = 0.0;
  });
  for (const char* part :
       {"/clips, clip 1: ", "/glove0 attribute 'polarity': expected 1 or -1, found 3",
        "/glove0/mask: expected 0 and 1, found 9",
        "/glove0/host_time_s: expected finite values, found nan at index 5",
        "/color/sequence: expected strictly increasing values, found 1 after 1 at index 2",
        "/board attribute 'columns': expected 2 to 1000, found 1",
        "/truth/time_s: expected times that do not run backward"})
    EXPECT_TRUE(mentions(fault, part)) << part << "\nin: " << fault;
}

TEST(Check, ListsAllDamagedImages) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  std::string bytes = read_file(folder / "a.h5");
  // The images are random numbers, which deflate stores uncompressed, so that their pixels can be
  // found in the file.
  const auto damage = [&](const RgbdFrame& frame) {
    const auto at = bytes.find(std::string(frame.color.begin() + 20, frame.color.begin() + 40));
    ASSERT_NE(at, std::string::npos);
    bytes[at] ^= 1;
  };
  damage(sample.frames[3]), damage(sample.frames[17]), damage(sample.board[1]);
  put(folder / "a.h5", bytes);
  const FileCheck check = check_file(folder / "a.h5", true);
  EXPECT_FALSE(check.is_usable());
  ASSERT_EQ(check.faults.size(), 2u);
  EXPECT_TRUE(mentions(check.faults[0], "a.h5: /color/image: image 3: ")) << check.faults[0];
  EXPECT_TRUE(mentions(check.faults[0], "(and images 17)")) << check.faults[0];
  EXPECT_TRUE(mentions(check.faults[1], "a.h5: /board/color: image 1: ")) << check.faults[1];
  EXPECT_TRUE(check_file(folder / "a.h5", false).faults.empty());
}

TEST(Check, RejectsMissingFilesAndOtherFormats) {
  const TemporaryFolder folder;
  expect_file_fault(folder / "none.h5", "does not exist");
  expect_file_fault(folder.path(), "is not a file");
  for (const char* text : {"", "hello, this is not a recording at all"}) {
    put(folder / "text.h5", text);
    expect_file_fault(folder / "text.h5", "is not an HDF5 file");
  }
  write(sample_recording(), folder / "r.h5");
  testing::expect_error([&] { read_labels(folder / "r.h5"); }, "touchtrace/recording/2");
}

TEST(Check, CalibrationNeedsDepthOfTheColourImagesSize) {
  auto sample = sample_recording();
  sample.board.push_back(sample.board[0]);
  EXPECT_TRUE(check_sample(sample).missing.at("calibrate").empty());
  sample.recording.camera.depth_width = 4, sample.recording.camera.depth_height = 3;
  sample.recording.camera.depth_camera.reset();
  for (auto* images : {&sample.frames, &sample.background, &sample.board})
    for (auto& frame : *images) frame.depth.resize(12);
  const FileCheck check = check_sample(sample);
  EXPECT_TRUE(check.missing.at("label").empty());
  EXPECT_TRUE(mentions(check.missing.at("calibrate").at(0), "have 4 x 3, colour images 8 x 6"));
}

TEST(Check, LabellingNeedsPlausibleBoxes) {
  const auto lacks = [](auto modify, bool has_calibration = true) {
    auto sample = sample_recording();
    modify(sample);
    const TemporaryFolder folder;
    write(sample, folder / "a.h5");
    const auto missing = missing_for_labelling(RecordingReader(folder / "a.h5"), has_calibration);
    return missing.empty() ? std::string() : missing.at(0);
  };
  const auto keep_only = [](auto& sample, std::size_t clip) {
    for (std::size_t i = 0; i < sample.recording.clips.size(); ++i)
      sample.recording.clips[i].object_fell = i != clip;
  };
  const auto with_hand_box = [&](PixelBox box) {
    return lacks([&](auto& sample) {
      keep_only(sample, 1);
      sample.recording.clips[1].hand_box = box;
    });
  };
  EXPECT_EQ(with_hand_box({0, 0, 8, 6}), "");
  EXPECT_TRUE(mentions(with_hand_box({3, 2, 7, 6}), "did you write corners (x1, y1, x2, y2)?"));
  EXPECT_TRUE(mentions(with_hand_box({-1, 2, 3, 4}),
                       "clip 1: hand_box (-1, 2, 3, 4) leaves the image of 8 x 6"));
  EXPECT_TRUE(mentions(with_hand_box({1, 2, -3, 4}), "negative size"));
  EXPECT_TRUE(mentions(with_hand_box({4, 1, 3, 3}), "hand_box and object_box are the same"));
  EXPECT_TRUE(mentions(with_hand_box({}), "in clip 1 (`touchtrace mark "));
  const auto with_box_frame = [&](bool has_other_clip) {
    return lacks([&](auto& sample) {
      if (!has_other_clip) keep_only(sample, 0);
      sample.recording.clips[0].box_frame = 50;
    });
  };
  EXPECT_TRUE(mentions(with_box_frame(false),
                       "clip 0: box_frame is 50, not one of its camera frames 0 to 26"));
  EXPECT_EQ(with_box_frame(true), "");  // the other clip can be labelled
  const auto unmarked = [](auto& sample) { sample.recording.clips[0].object_box = {}; };
  EXPECT_EQ(lacks(unmarked), "");  // the clip has a mask of both
  EXPECT_TRUE(mentions(lacks([](auto&) {}, false), "give --calibration"));
  EXPECT_EQ(lacks(
                [](auto& sample) {
                  sample.recording.camera.is_registered = true;
                  sample.recording.camera.color_camera = sample.recording.camera.depth_camera;
                },
                false),
            "");
}

TEST(Check, RejectsTruncatedFiles) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  const std::string whole = read_file(folder / "a.h5");
  for (int part = 1; part <= 20; ++part) {
    put(folder / "b.h5", whole.substr(0, whole.size() * part / 21));
    expect_file_fault(folder / "b.h5", "");
  }
  put(folder / "b.h5", whole.substr(0, whole.size() - 1));
  expect_file_fault(folder / "b.h5", "");
}

TEST(Check, DescribesLabels) {
  const TemporaryFolder folder;
  Labels labels = sample_labels(sample_recording().recording);
  labels.object.quality[0] = quality_lost;
  write_labels(folder / "l.h5", labels, false);
  FileCheck check = check_file(folder / "l.h5", true);
  EXPECT_TRUE(check.is_usable());
  EXPECT_EQ(check.contents.at("labels"), 40);
  EXPECT_DOUBLE_EQ(check.contents.at("object").at("lost_share").get<double>(), 1.0 / 40.0);
  labels.hand.quality.assign(40, quality_lost);
  write_labels(folder / "l.h5", labels, true);
  EXPECT_FALSE(check_file(folder / "l.h5", true).is_usable());
}

}  // namespace
}  // namespace touchtrace
