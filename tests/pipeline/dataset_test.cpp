#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "engine/base/error.h"
#include "pipeline/dataset/fingerprint.h"
#include "pipeline/dataset/load.h"
#include "pipeline/dataset/tactile_image.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::sample_labels;
using testing::sample_recording;
using testing::SampleRecording;
using testing::TemporaryFolder;

/// Sample files, which a test modifies before it writes them.
struct Files {
  SampleRecording sample = sample_recording();
  Labels labels = sample_labels(sample.recording);
  TemporaryFolder folder;

  LabelledRecording write_files() {
    write(sample, folder / "r.h5", true, true);
    write_labels(folder / "l.h5", labels, true);
    return {folder / "r.h5", folder / "l.h5"};
  }
};

TEST(AreaAverage, PreservesTheMean) {
  std::vector<float> image(32 * 32);
  RandomStream random(1, "image");
  for (float& value : image) value = static_cast<float>(random.uniform());
  const double mean = std::accumulate(image.begin(), image.end(), 0.0) / 1024.0;
  for (int size : {32, 31, 24, 16, 12, 8, 7, 6, 1}) {
    std::vector<float> coarse(static_cast<std::size_t>(size * size));
    AreaAverage(32, 32, size, size).apply(image, coarse);
    const double coarse_mean = std::accumulate(coarse.begin(), coarse.end(), 0.0) / (size * size);
    // Each cell sums up to 32 x 32 products of at most 1, each rounded with an error of 2^-24.
    EXPECT_NEAR(coarse_mean, mean, 1024 * 0x1p-24) << size;
  }
}

TEST(AreaAverage, GloveWithTooFewTaxelsIsRefused) {
  try {
    AreaAverage(13, 32, 32, 32);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("13 taxels along an axis"), std::string::npos);
    EXPECT_NE(error.hint().find("give --resolution 13 or less"), std::string::npos);
  }
}

TEST(AreaAverage, SplitsATaxelBetweenCellsByArea) {
  const std::vector<float> row{1.0f, 10.0f, 100.0f};
  std::vector<float> halves(2);
  AreaAverage(1, 3, 1, 2).apply(row, halves);
  EXPECT_FLOAT_EQ(halves[0], (1.0f + 5.0f) / 1.5f);
  EXPECT_FLOAT_EQ(halves[1], (5.0f + 100.0f) / 1.5f);
  EXPECT_THROW(AreaAverage(3, 3, 4, 3), Error);
}

TEST(Pressure, UsesPolarityBaselineRangeAndMask) {
  GloveInfo info;
  info.rows = 1, info.cols = 4, info.bits = 10, info.polarity = -1;
  info.baseline_counts = {1000.0f, 1000.0f, 1000.0f, 1000.0f};
  info.mask = {1, 1, 0, 1};
  const std::vector<std::uint16_t> counts{1000, 488, 488, 1023};
  std::vector<float> pressure(4);
  counts_to_pressure(info, counts, pressure);
  EXPECT_EQ(pressure, (std::vector<float>{0.0f, 512.0f / 1023.0f, 0.0f, 0.0f}));
}

TEST(Splits, HaveSeventyFiveFiveTwentyPercentOfTheClips) {
  std::array<int, 4> count{};
  for (int clip = 0; clip < 100; ++clip) ++count[static_cast<std::size_t>(split_of_clip(clip))];
  EXPECT_EQ(count, (std::array<int, 4>{70, 5, 5, 20}));
}

TEST(Dataset, SequencesAreWholeClipsInOrder) {
  Files files;
  const Dataset data = load_dataset({files.write_files()});
  ASSERT_EQ(data.sequences.size(), 2u);
  EXPECT_EQ(data.sequences[1].object, "box");
  int next = 0;
  for (const auto& sequence : data.sequences) {
    EXPECT_EQ(sequence.first_frame, next);
    const Clip& clip = files.sample.recording.clips[static_cast<std::size_t>(sequence.clip)];
    for (int f = next; f < next + sequence.frames; ++f) {
      EXPECT_GE(data.time_s[f], clip.start_s);
      EXPECT_LE(data.time_s[f], clip.end_s);
    }
    next += sequence.frames;
  }
  EXPECT_EQ(next, data.frames());
  EXPECT_EQ(data.frames(), 40);
  EXPECT_EQ(data.tactile.size(), 40u * 30u);
}

TEST(Dataset, SplitCountsTheClipsOfEachObject) {
  Files files;
  EXPECT_EQ(load_dataset({files.write_files()}).sequences[1].split, Split::train);
  for (auto* clips : {&files.labels.clips, &files.sample.recording.clips})
    (*clips)[1].object = (*clips)[0].object;
  EXPECT_EQ(load_dataset({files.write_files()}).sequences[1].split, Split::evaluation);
}

TEST(Dataset, FingerprintOfTouchIsIndependentOfLabelsImagesAndBoxes) {
  Files files;
  const auto fingerprints = [&] {
    const Dataset data = load_dataset({files.write_files()});
    return std::pair(data.sequences[0].fingerprints[0], data.sequences[1].fingerprints[0]);
  };
  const auto first = fingerprints();
  EXPECT_NE(first.first, first.second);
  files.labels.object.position_m[0] += 1.0;
  files.sample.frames[0].color[0] ^= 1;
  files.sample.recording.clips[0].hand_box = {};
  EXPECT_EQ(fingerprints(), first);
  files.sample.recording.gloves[0].counts[3] ^= 1;
  EXPECT_NE(fingerprints().first, first.first);
  EXPECT_EQ(fingerprints().second, first.second);
}

TEST(Dataset, RejectsLabelsThatAreNotOnePerFrame) {
  const auto expect_fault = [](const std::string& fault, auto change) {
    Files files;
    change(files.labels);
    try {
      load_dataset({files.write_files()});
      ADD_FAILURE() << "accepted: " << fault;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
    }
  };
  expect_fault("one label for each frame", [](Labels& l) { l.glove_frame[5] = l.glove_frame[4]; });
  expect_fault("one label for each frame",
               [](Labels& l) { std::swap(l.glove_frame[5], l.glove_frame[6]); });
  expect_fault("clip 1 is from", [](Labels& l) { l.clips[1].start_s += 0.3; });
  expect_fault("clip 1 is of object 'hammer' instead of",
               [](Labels& l) { l.clips[1].object = "hammer"; });
}

TEST(Dataset, RejectsACopyOfARecording) {
  Files files;
  const LabelledRecording original = files.write_files(),
                          copy{files.folder / "copy.h5", original.labels};
  write(files.sample, copy.recording, true, true);
  try {
    load_dataset({original, copy});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("copy.h5 is also in another"), std::string::npos)
        << error.what();
  }
}

TEST(Dataset, RejectsACopyWithOtherCounts) {
  Files files;
  RandomStream random(4, "motion");
  do {  // until a clip, which is short, keeps two stretches
    for (auto* body : {&files.labels.hand, &files.labels.object}) {
      for (double& value : body->position_m) value = random.uniform();
      body->quality.assign(body->quality.size(), quality_good);
    }
  } while (motion_fingerprints(files.labels, {0, 20}).size() < 2);
  const LabelledRecording original = files.write_files(),
                          copy{files.folder / "copy.h5", original.labels};
  for (auto& glove : files.sample.recording.gloves)
    for (auto& count : glove.counts) count ^= 1;
  write(files.sample, copy.recording, true, true);
  testing::expect_error([&] { load_dataset({original, copy}); }, "copy.h5 is also in another", {});
}

/// Removes the last labels of the last clip.
void remove_last(Labels& labels, std::size_t count) {
  const std::size_t left = labels.time_s.size() - count;
  labels.time_s.resize(left), labels.clip.resize(left), labels.glove_frame.resize(left);
  for (auto* body : {&labels.hand, &labels.object}) {
    for (auto* values : {&body->position_m, &body->velocity_m_per_s, &body->causal_position_m,
                         &body->causal_velocity_m_per_s})
      values->resize(3 * left);
    body->covariance.resize(36 * left), body->quality.resize(left);
    body->error_budget_m.clear();
  }
}

TEST(Dataset, WarnsOfMissingLabels) {
  Files files;
  const auto is_warned = [&] {
    return std::ranges::any_of(load_dataset({files.write_files()}).warnings, [](const auto& text) {
      return text.find("frames in clips have no label") != std::string::npos;
    });
  };
  EXPECT_FALSE(is_warned());
  const Labels all = files.labels;
  remove_last(files.labels, 10);
  EXPECT_TRUE(is_warned());
  files.labels = all;
  files.sample.recording.clips[1].object_fell = files.labels.clips[1].object_fell = true;
  remove_last(files.labels, 20);
  EXPECT_FALSE(is_warned()) << "no labels of a dropped clip";
}

TEST(Dataset, LostFrameRepeatsThePreviousImage) {
  Files files;
  const Dataset data = load_dataset({files.write_files()});
  const auto image = [&](int f) {
    return std::span(data.tactile).subspan(static_cast<std::size_t>(f) * 30, 30);
  };
  ASSERT_EQ(files.labels.glove_frame[7], -1);
  EXPECT_TRUE(std::ranges::equal(image(7), image(6)));
  EXPECT_FALSE(std::ranges::equal(image(8), image(7)));
}

TEST(Dataset, HasTheRateOfItsFrames) {
  Files files;
  EXPECT_NEAR(load_dataset({files.write_files()}).rate_hz, 15.0, 0.05);
  files.sample.recording.gloves[0].info.rate_hz = 30.0;
  const Dataset data = load_dataset({files.write_files()});
  EXPECT_NEAR(data.rate_hz, 15.0, 0.05);
  EXPECT_TRUE(std::ranges::any_of(data.warnings, [](const std::string& warning) {
    return warning.find("rate_hz is 30") != std::string::npos;
  }));
}

TEST(Dataset, StatesAreObjectThenHand) {
  Files files;
  const Dataset data = load_dataset({files.write_files()});
  EXPECT_EQ(data.label[3][1], static_cast<float>(files.labels.object.position_m[10]));
  EXPECT_EQ(data.label[3][4], static_cast<float>(files.labels.object.velocity_m_per_s[10]));
  EXPECT_EQ(data.label[3][7], static_cast<float>(files.labels.hand.position_m[10]));
  EXPECT_EQ(data.causal_label[3][10],
            static_cast<float>(files.labels.hand.causal_velocity_m_per_s[10]));
}

TEST(Dataset, SkipsFallenObjectsAndDoesNotTrustNaN) {
  Files files;
  files.labels.object.quality[2] = quality_follows_hand;
  files.labels.clips[1].object_fell = true;
  const Dataset data = load_dataset({files.write_files()});
  ASSERT_EQ(data.sequences.size(), 1u);
  EXPECT_EQ(data.trusted[2], 0);
  EXPECT_EQ(data.trusted[3], 1);

  files.labels.clips[1].object_fell = false;
  files.labels.hand.quality[5] = quality_lost;
  files.labels.hand.position_m[15] = std::nan("");
  const Dataset other = load_dataset({files.write_files()});
  EXPECT_EQ(other.sequences.size(), 2u);
  EXPECT_EQ(std::ranges::count(other.trusted, 1), 38);
  EXPECT_EQ(other.trusted[5], 0);
  EXPECT_EQ(other.label[5], State{});
}

TEST(Dataset, RejectsLabelsOfAnotherRecording) {
  Files files;
  const auto source = files.write_files();
  files.labels.provenance.add_input(source.recording);
  EXPECT_NO_THROW(load_dataset({files.write_files()}));
  files.labels.provenance.inputs[0].sha256[0] ^= 1;
  EXPECT_THROW(load_dataset({files.write_files()}), Error);
  files.labels.provenance.inputs.clear();
  for (double& t : files.labels.time_s) t += 5.0;
  EXPECT_THROW(load_dataset({files.write_files()}), Error);
  files.labels.activity = "throw";
  EXPECT_THROW(load_dataset({files.write_files()}), Error);
}

TEST(Dataset, RejectsMissingGloveAndTooHighResolution) {
  Files files;
  EXPECT_THROW(load_dataset({files.write_files()}, 6), Error);
  EXPECT_EQ(load_dataset({files.write_files()}, 5).cols, 5);
  files.sample.recording.gloves.clear();
  EXPECT_THROW(load_dataset({files.write_files()}), Error);
}

TEST(Dataset, RejectsZeroAndSaturatedGloves) {
  for (std::uint16_t counts : {0, 1023}) {
    Files files;
    std::ranges::fill(files.sample.recording.gloves[0].counts, counts);
    EXPECT_THROW(load_dataset({files.write_files()}), Error);
  }
}

TEST(Dataset, NormalizationUsesTrustedTrainingLabels) {
  Files files;
  files.labels.object.quality[4] = quality_lost;
  for (auto* clips : {&files.labels.clips, &files.sample.recording.clips})
    (*clips)[1].object = (*clips)[0].object;
  const Dataset data = load_dataset({files.write_files()});
  const Normalization scaling = fit_normalization(data);
  std::vector<double> values;
  for (int f = 0; f < 20; ++f)
    if (f != 4) values.push_back(data.label[f][9]);
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / 19.0;
  double square = 0.0;
  for (double value : values) square += (value - mean) * (value - mean);
  EXPECT_FLOAT_EQ(scaling.mean[9], static_cast<float>(mean));
  EXPECT_FLOAT_EQ(scaling.sigma[9], static_cast<float>(std::sqrt(square / 19.0)));
  const State back = scaling.denormalize(scaling.normalize(data.label[3]));
  for (int d = 0; d < state_size; ++d) EXPECT_NEAR(back[d], data.label[3][d], 1e-5);
}

TEST(Dataset, TruthIsInterpolatedAtLabelTimes) {
  Files files;
  const auto source = files.write_files();
  Dataset data = load_dataset({source});
  EXPECT_TRUE(data.truth.empty());
  attach_truth(data, {source});
  ASSERT_EQ(data.truth.size(), data.label.size());
  for (int f = 0; f < data.frames(); ++f)
    for (int d = 0; d < 3; ++d) {
      const double rate = d + 1.0, t = data.time_s[f], h = 1.0 / testing::sample_truth_rate_hz;
      // Error bounds for 0.1 sin(rate t): Hermite h^4/384 max|p''''|, linear h^2/8 max|v''|. At a
      // clip's end, extrapolation by up to one interval: h^2/2 max|p''| and h max|v'|. Plus half a
      // unit in the last place of a float.
      const bool inside =
          t <= files.sample.recording.clips[data.sequences[f < 20 ? 0 : 1].clip].end_s - h;
      const double position_bound =
          inside ? std::pow(h * rate, 4) / 3840 : std::pow(h * rate, 2) / 20;
      const double velocity_bound =
          inside ? rate * std::pow(h * rate, 2) / 80 : rate * rate * h / 10;
      EXPECT_NEAR(data.truth[f][d], 0.1 * std::sin(rate * t), position_bound + 1e-8);
      EXPECT_NEAR(data.truth[f][d + 9], 0.1 * rate * std::cos(rate * t + 0.5),
                  velocity_bound + 2e-8);
    }
}

}  // namespace
}  // namespace touchtrace
