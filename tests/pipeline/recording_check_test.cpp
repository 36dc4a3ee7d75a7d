#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/stream_check.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::put;
using testing::sample_labels;
using testing::sample_recording;
using testing::SampleRecording;
using testing::TemporaryFolder;

FileCheck checked(const SampleRecording& sample) {
  const TemporaryFolder folder;
  write(sample, folder / "a.h5");
  return check_file(folder / "a.h5", true);
}

/// The message of the data_error that reading `path` has to end in.
std::string fault_of(const std::filesystem::path& path) {
  try {
    check_file(path, true);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data) << error.what();
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  ADD_FAILURE() << path << " was accepted";
  return {};
}

std::string fault_of(const SampleRecording& sample) {
  const TemporaryFolder folder;
  write(sample, folder / "a.h5");
  return fault_of(folder / "a.h5");
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Check, SaysWhatASoundRecordingHolds) {
  const FileCheck check = checked(sample_recording());
  EXPECT_TRUE(check.good());
  for (const char* verb : {"calibrate", "label", "train"}) {
    if (std::string(verb) == "calibrate") continue;  // two views of the board are too few
    EXPECT_TRUE(check.lacks.at(verb).empty()) << verb;
  }
  EXPECT_EQ(check.lacks.at("calibrate").size(), 1u);
  const auto& glove = check.holds.at("gloves").at(0);
  EXPECT_EQ(glove.at("frames"), 38);
  EXPECT_EQ(glove.at("lost"), 2);
  EXPECT_EQ(glove.at("taxels"), 29);
  EXPECT_EQ(glove.at("dead_taxels"), 0);
  // 1 ms of uniform jitter deviates by 1/sqrt(12) ms; over 38 frames the estimate by far less than
  // half.
  EXPECT_NEAR(glove.at("jitter_s").get<double>(), 1e-3 / std::sqrt(12.0), 0.5e-3 / std::sqrt(12.0));
  EXPECT_NEAR(glove.at("rate_hz").get<double>(), 15.0, 0.05);
  EXPECT_EQ(check.holds.at("clips").at("objects").at("ball"), 1);
  EXPECT_EQ(check.holds.at("truth"), true);
}

TEST(Check, TimingIsThatOfTheCounterAgainstTheClock) {
  const std::vector<std::uint64_t> sequence{10, 11, 13, 14, 20};
  std::vector<double> time_s;
  for (auto number : sequence) time_s.push_back(100.0 + 0.05 * static_cast<double>(number));
  const StreamTiming timing = timing_of(sequence, time_s, {});
  EXPECT_EQ(timing.lost, 6u);
  EXPECT_NEAR(timing.rate_hz, 20.0, 1e-9);
  EXPECT_NEAR(timing.jitter_s, 0.0, 1e-7);
  EXPECT_TRUE(std::isnan(timing_of({1, 2}, {0.0, 1.0}, {}).rate_hz));
}

TEST(Check, NamesWhatEachVerbLacks) {
  auto no_glove = sample_recording();
  no_glove.recording.gloves.clear();
  no_glove.board.push_back(no_glove.board[0]);
  FileCheck check = checked(no_glove);
  EXPECT_TRUE(check.good());
  EXPECT_TRUE(check.lacks.at("calibrate").empty());
  EXPECT_EQ(check.lacks.at("label"), std::vector<std::string>{"it has no glove"});
  EXPECT_EQ(check.lacks.at("train"), std::vector<std::string>{"it has no glove"});

  auto no_depth = sample_recording();
  for (auto* images : {&no_depth.frames, &no_depth.background, &no_depth.board})
    for (auto& frame : *images) frame.depth.clear();
  check = checked(no_depth);
  EXPECT_EQ(check.lacks.at("label"), std::vector<std::string>{"its camera images have no depth"});

  auto fallen = sample_recording();
  for (auto& clip : fallen.recording.clips) clip.dropped = true;
  EXPECT_FALSE(checked(fallen).good());
}

TEST(Check, OneFrameIsReadButServesNothing) {
  auto sample = sample_recording();
  auto& glove = sample.recording.gloves[0];
  glove.sequence.resize(1), glove.host_time_s.resize(1), glove.counts.resize(30);
  auto& times = sample.recording.camera_times;
  times.sequence.resize(1), times.host_time_s.resize(1), times.device_time_s.resize(1);
  sample.frames.resize(1);
  const FileCheck check = checked(sample);
  EXPECT_FALSE(check.good());
  EXPECT_EQ(check.lacks.at("label").size(), 2u);
}

TEST(Check, FindsGlovesThatFeltNothingOrTooMuch) {
  const auto with_counts = [](int polarity, std::uint16_t counts) {
    auto sample = sample_recording();
    sample.recording.gloves[0].info.polarity = polarity;
    std::ranges::fill(sample.recording.gloves[0].counts, counts);
    return checked(sample);
  };
  EXPECT_TRUE(mentions(with_counts(1, 0).faults.at(0), "all zero"));
  EXPECT_TRUE(mentions(with_counts(1, 1023).faults.at(0), "saturated"));
  EXPECT_TRUE(mentions(with_counts(-1, 0).faults.at(1), "saturated"));
  EXPECT_TRUE(mentions(with_counts(1, 300).faults.at(0), "never change"));
  EXPECT_FALSE(with_counts(1, 300).good());
}

TEST(Check, RefusesTimesThatDoNotAdvance) {
  auto sample = sample_recording();
  sample.recording.gloves[0].host_time_s[5] = sample.recording.gloves[0].host_time_s[4];
  EXPECT_TRUE(mentions(fault_of(sample), "/glove0/host_time_s"));
  sample = sample_recording();
  sample.recording.camera_times.host_time_s[9] = 0.0;
  EXPECT_TRUE(mentions(fault_of(sample), "/camera/host_time_s"));
  sample = sample_recording();
  std::swap(sample.recording.gloves[0].sequence[2], sample.recording.gloves[0].sequence[3]);
  EXPECT_TRUE(mentions(fault_of(sample), "/glove0/sequence"));
  sample = sample_recording();
  std::swap(sample.recording.clips[0], sample.recording.clips[1]);
  EXPECT_TRUE(mentions(fault_of(sample), "clip 1 starts before"));
}

TEST(Check, RefusesNotANumber) {
  auto sample = sample_recording();
  sample.recording.camera_times.device_time_s[3] = std::nan("");
  EXPECT_TRUE(mentions(fault_of(sample), "value 3 is not finite"));
  sample = sample_recording();
  sample.recording.gloves[0].info.baseline_counts[7] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(mentions(fault_of(sample), "baseline"));
  sample = sample_recording();
  sample.recording.clips[0].end_s = std::nan("");
  EXPECT_TRUE(mentions(fault_of(sample), "clip 0"));
  sample = sample_recording();
  sample.truth.object.position_m[1] = std::nan("");
  const TemporaryFolder folder;
  write(sample, folder / "a.h5");
  EXPECT_THROW(read_truth(folder / "a.h5"), Error);
}

TEST(Check, RefusesImpossibleAttributes) {
  const auto refused = [](auto bend) {
    auto sample = sample_recording();
    bend(sample.recording);
    return fault_of(sample);
  };
  EXPECT_TRUE(mentions(refused([](auto& r) { r.gloves[0].info.polarity = 0; }), "polarity"));
  EXPECT_TRUE(mentions(refused([](auto& r) { r.gloves[0].info.bits = 8; }), "8 bits"));
  EXPECT_TRUE(mentions(refused([](auto& r) { r.gloves[0].info.rate_hz = 0.0; }), "rate"));
  EXPECT_TRUE(mentions(refused([](auto& r) { r.gloves[0].info.mask.assign(30, 0); }), "mask"));
  EXPECT_TRUE(mentions(refused([](auto& r) { r.board.square_m = 0.0; }), "chessboard"));
  EXPECT_TRUE(mentions(refused([](auto& r) { r.activity.clear(); }), "activity"));
}

TEST(Check, NamesMissingAndForeignFiles) {
  const TemporaryFolder folder;
  EXPECT_TRUE(mentions(fault_of(folder / "none.h5"), "does not exist"));
  EXPECT_TRUE(mentions(fault_of(folder.path()), "is no file"));
  put(folder / "empty.h5", "");
  EXPECT_TRUE(mentions(fault_of(folder / "empty.h5"), "no HDF5"));
  put(folder / "text.h5", "hello, this is not a recording at all");
  EXPECT_TRUE(mentions(fault_of(folder / "text.h5"), "no HDF5"));
  write(sample_recording(), folder / "r.h5");
  try {
    read_labels(folder / "r.h5");
    ADD_FAILURE() << "a recording was read as labels";
  } catch (const Error& error) {
    EXPECT_TRUE(mentions(error.what(), "touchtrace/recording/1"));
  }
}

TEST(Check, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  const std::string whole = read_file(folder / "a.h5");
  for (int part = 1; part <= 20; ++part) {
    put(folder / "b.h5", whole.substr(0, whole.size() * part / 21));
    EXPECT_FALSE(fault_of(folder / "b.h5").empty());
  }
  put(folder / "b.h5", whole.substr(0, whole.size() - 1));
  EXPECT_FALSE(fault_of(folder / "b.h5").empty());
}

TEST(Check, LabelsAreToldApartAndJudged) {
  const TemporaryFolder folder;
  Labels labels = sample_labels(sample_recording().recording);
  labels.object.quality[0] = quality_lost;
  write_labels(folder / "l.h5", labels, false);
  FileCheck check = check_file(folder / "l.h5", true);
  EXPECT_TRUE(check.good());
  EXPECT_EQ(check.holds.at("labels"), 40);
  EXPECT_DOUBLE_EQ(check.holds.at("object").at("lost_share").get<double>(), 1.0 / 40.0);
  labels.hand.quality.assign(40, quality_lost);
  write_labels(folder / "l.h5", labels, true);
  EXPECT_FALSE(check_file(folder / "l.h5", true).good());
}

}  // namespace
}  // namespace touchtrace
