#include "tests/pipeline/import_glove_samples.h"

namespace touchtrace {
namespace {

TEST_F(ImportGlove, PressuresBecomeCountsOf16Bits) {
  const GloveStream stream = glove(with_glove("fraction.npz"));
  EXPECT_EQ(stream.info.bits, 16);
  EXPECT_EQ(stream.info.polarity, 1);
  // 1 - 2999 / 4095 as float, times 65535
  EXPECT_EQ(stream.counts[0], std::lround((1.0 - 2999.0 / 4095.0) * 65535.0));
}

TEST_F(ImportGlove, NumpyArraysMayHaveAnyOrderOfBytesAndAxes) {
  expect_counts(glove(with_glove("columns.npz")), 300);
  expect_counts(glove(with_glove("dates.npz")), 300);
  const GloveStream half = glove(with_glove("half.npz"));
  for (int i = 0; i < taxels; ++i) EXPECT_EQ(half.counts[std::size_t(i)], glove_count(0, i) - 2000);
  expect_glove_rejected(with_glove("single.npy"), "numpy.savez");
}

/// MATLAB users put frames last.
TEST_F(ImportGlove, FramesMayBeOfAnyAxis) {
  for (const char* name : {"last.npz", "middle.npz"}) {
    auto options = with_layout(with_glove(name));
    options.source.rate_hz = 20.0;
    const GloveStream stream = import_alone(options);
    ASSERT_EQ(stream.frames(), 300u) << name;
    for (int frame : {0, 1, 299})
      for (int i = 0; i < taxels; ++i)
        EXPECT_EQ(stream.counts[std::size_t(frame * taxels + i)], glove_count(frame, i));
    options.glove.layout.rows = options.glove.layout.cols = 0;
    expect_glove_rejected(options, "give --rows and --cols");
  }
}

/// Recordings 0 and 7 of one file.
TEST_F(ImportGlove, RecordingOfAMatlabFileIsChosen) {
  fs::copy_file(fs::path(TOUCHTRACE_SOURCE_DIR) / "tests" / "data" / "matlab" / "stag.mat",
                folder_ / "metadata.mat");
  auto options = with_glove("metadata.mat");
  expect_glove_rejected(options,
                        "--glove-stream with a number of its array recordingId, from 0 to 7");
  options.glove.layout.stream = "3";
  expect_glove_rejected(options, "no recording '3'");
  options.glove.layout.stream = "7";
  expect_counts(glove(options), 300);
}

TEST_F(ImportGlove, RecordingOfAMatlabFileMayHaveFramesLast) {
  fs::copy_file(
      fs::path(TOUCHTRACE_SOURCE_DIR) / "tests" / "data" / "matlab" / "stag_frames_last.mat",
      folder_ / "last.mat");
  auto options = with_glove("last.mat");
  options.glove.layout.stream = "7";
  expect_counts(glove(options), 300);
}

TEST_F(ImportGlove, ValuesWithFractionsAreScaledTo16Bits) {
  const auto counts = [&](double low, double high, double baseline) {
    const auto row = [&](int i) {
      return fmt::format("{},{:.5f},{:.5f}\n", 0.05 * i, low, low + (high - low) * i / 59);
    };
    auto options = table("time_s,a,b\n", row, 1, 2, 60);
    options.glove.baseline_counts = baseline;
    return import_alone(options);
  };
  const GloveStream volts = counts(0.5, 2.7, 0.5);  // 4 V are 65535
  EXPECT_EQ(volts.info.bits, 16);
  EXPECT_EQ(volts.counts[0], std::lround(0.5 / 4.0 * 65535));
  EXPECT_EQ(volts.counts[119], std::lround(2.7 / 4.0 * 65535));
  EXPECT_FLOAT_EQ(volts.info.baseline_counts[0], 0.5f / 4.0f * 65535.0f);
  EXPECT_EQ(counts(0.25, 1.002, -1.0).counts[119], std::lround(1.002 / 2.0 * 65535));
  EXPECT_EQ(counts(0.0001, 0.0035, -1.0).counts[119], std::lround(0.0035 * 256 * 65535));
  const GloveStream tared = counts(-0.4, 3.1, -1.0);  // -0.5 to 4
  EXPECT_EQ(tared.counts[0], std::lround(0.1 / 4.5 * 65535));
  EXPECT_EQ(counts(-30.0, 29.0, 0.0).counts[119], 59) << "whole numbers are shifted";
  EXPECT_EQ(counts(-30.0, 29.0, 0.0).info.baseline_counts[0], 30.0f);
}

TEST_F(ImportGlove, ContactsAreFullScale) {
  const GloveStream contacts = glove(alone("bool.npz", 4, 3));
  EXPECT_EQ(contacts.counts[0], 65535);
  EXPECT_EQ(contacts.info.bits, 16);
  auto counts = alone("bool.npz", 4, 3);
  counts.glove.bits = 10;
  EXPECT_EQ(glove(counts).counts[0], 1) << "of a converter";
}

TEST_F(ImportGlove, NamesOfColumnsTellTheTaxels) {
  const auto import_names = [&](const std::string& names) {
    return table("time_s," + names + "\n",
                 [](int i) { return fmt::format("{},10,20,30,40,50,60\n", 0.05 * i); });
  };
  const auto first_frame = [&](const std::string& names) {
    const GloveStream stream = import_alone(import_names(names));
    EXPECT_EQ(stream.info.rows, 3);
    return std::vector<int>(stream.counts.begin(), stream.counts.begin() + 6);
  };
  const std::vector<int> in_order{10, 20, 30, 40, 50, 60}, by_columns{10, 40, 20, 50, 30, 60};
  EXPECT_EQ(first_frame("0_0,0_1,1_0,1_1,2_0,2_1"), in_order);
  EXPECT_EQ(first_frame("counts_1_1,counts_1_2,counts_2_1,counts_2_2,counts_3_1,counts_3_2"),
            in_order);
  EXPECT_EQ(first_frame("counts_0_0,counts_1_0,counts_2_0,counts_0_1,counts_1_1,counts_2_1"),
            by_columns);
  expect_glove_rejected(import_names("0_0,0_1,1_0,1_1,2_0,3_1"), "has no column '2_1'");
  expect_glove_rejected(import_names("0_0,0_1,1_0,1_1,2_0,2_0"), "has two columns '2_0'");
  auto options = import_names("0_0,0_1,1_0,1_1,2_0,2_1");
  options.glove.layout.rows = 2;
  expect_glove_rejected(options, "leave out --rows and --cols");
}

TEST_F(ImportGlove, UnitOfStampsIsThatOfAPlausibleRate) {
  const auto with_stamps = [&](double first, double step, const char* name) {
    const auto row = [&](int i) { return fmt::format("{:.0f},5\n", first + step * i); };
    return table(fmt::format("{},a\n", name), row, 1, 1, 60);
  };
  const auto rate_hz = [&](double first, double step) {
    const GloveStream stream = import_alone(with_stamps(first, step, "timestamp"));
    EXPECT_NEAR(stream.host_time_s[59] - stream.host_time_s[0], 59 / stream.info.rate_hz, 1e-6);
    return stream.info.rate_hz;
  };
  EXPECT_NEAR(rate_hz(8e12, 5e7), 20.0, 1e-3) << "ns since the computer's start";
  EXPECT_NEAR(rate_hz(1e14 - 1.5e9, 5e7), 20.0, 1e-3) << "ns that cross 1e14";
  EXPECT_NEAR(rate_hz(0.0, 50.0), 20.0, 1e-3) << "ms since the start";
  EXPECT_NEAR(rate_hz(1.7e18, 5e7), 20.0, 1e-3);
  EXPECT_NEAR(rate_hz(3e6, 1.0), 1.0, 1e-3) << "s since the start, over 10^6 s ago";
  EXPECT_NO_THROW(RecordingReader(folder_ / "out.h5"));
  expect_glove_rejected(with_stamps(0.0, 1e11, "timestamp"), "name it with its unit");
  expect_glove_rejected(with_stamps(7.0, 0.0, "timestamp"), "span 0 s");
}

TEST_F(ImportGlove, FramesThatShareAStampAreSpread) {
  const auto row = [](int i) {  // 20 Hz, whole seconds, from the middle of a second on
    return fmt::format("{},5\n", 1700000000 + (i + 10) / 20);
  };
  const GloveStream stream = import_alone(table("time_s,a\n", row, 1, 1, 100));
  EXPECT_NEAR(stream.info.rate_hz, 20.0, 1e-6);
  for (std::size_t i = 1; i < 100; ++i)
    EXPECT_NEAR(stream.host_time_s[i] - stream.host_time_s[i - 1], 0.05, 1e-6);
}

TEST_F(ImportGlove, DatesInATableAreTimes) {
  const auto row = [](int i) {
    return fmt::format("2023-11-14T22:13:{:02}.{}+00:00,5\n", 20 + i / 2, i % 2 * 5);
  };
  EXPECT_NEAR(import_alone(table("timestamp,a\n", row, 1, 1, 60)).info.rate_hz, 2.0, 1e-6);
  EXPECT_NEAR(RecordingReader(folder_ / "out.h5").recording().epoch_unix_s, glove_start_s, 1e-5);
}

TEST_F(ImportGlove, EpochOfATableIsKept) {
  const auto row = [](int i) { return fmt::format("{},{},5\n", 0.05 * i - 0.25, glove_start_s); };
  const auto options = table("time_s,epoch_unix_s,counts_0_0\n", row, 1, 1, 60);
  EXPECT_EQ(import_alone(options).host_time_s[0], -0.25);
  EXPECT_EQ(RecordingReader(folder_ / "out.h5").recording().epoch_unix_s, glove_start_s);
  write_import_tum(folder_ / "tum");
  EXPECT_NEAR(import("tum", options).recording().gloves.at(0).host_time_s[0], -0.5, 1e-6);
}

TEST_F(ImportGlove, ExportedNumbersAreReadBack) {
  const auto row = [](int i) { return i == 30 ? "" : fmt::format("{},{},5\n", 0.05 * i, 100 + i); };
  const GloveStream stream = import_alone(table("time_s,sequence,counts_0_0\n", row, 1, 1, 60));
  EXPECT_EQ(stream.sequence[30] - stream.sequence[29], 2u);
  EXPECT_EQ(RecordingReader(folder_ / "out.h5").recording().clips.size(), 1u);
  testing::put(folder_ / "a.csv", "time_s,sequence,a\n0,7,1\n0.1,7,1\n0.2,8,1\n0.3,8,1\n");
  EXPECT_EQ(import_alone(alone("a.csv", 1, 1)).sequence.back(), 3u) << "does not count frames";
}

}  // namespace
}  // namespace touchtrace
