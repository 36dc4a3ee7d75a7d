#include <cstdlib>

#include "pipeline/acquire/import/glove_import.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

constexpr double glove_start_s = 1700000000.0;  // of write_glove_files.py
constexpr int rest_frames = 60, taxels = 12;

/// Count of taxel `i` as write_glove_files.py has it.
int glove_count(int frame, int i) {
  const int row = i / 3, col = i % 3;
  const bool is_pressed = frame >= rest_frames && frame % 40 < 20;
  return 3000 + 10 * row + col + (7 * frame + col) % 3 - 1 - (is_pressed ? 800 : 0);
}

class ImportGlove : public Import {
 protected:
  void SetUp() override {
    Import::SetUp();
    const std::string command = std::string("/usr/bin/python3 ") + TOUCHTRACE_SOURCE_DIR +
                                "/tests/pipeline/write_glove_files.py " + folder_.path().string();
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  ImportOptions with_glove(const std::string& name) const {
    ImportOptions options;
    options.glove.file = folder_ / name;
    options.glove.rest_s = 3.0;
    return options;
  }
  static ImportOptions with_layout(ImportOptions options) {
    options.glove.layout.rows = 4, options.glove.layout.cols = 3;
    return options;
  }
  /// Imports a glove alone.
  GloveStream glove(const ImportOptions& options) {
    summary_ = import_recording({}, folder_ / "out.h5", options,
                                start_provenance("touchtrace/recording/2", "import"), true);
    const RecordingReader reader(folder_ / "out.h5");
    EXPECT_EQ(reader.recording().camera_times.frames(), 0u);
    EXPECT_NEAR(reader.recording().epoch_unix_s, glove_start_s, 1e-5);
    return reader.recording().gloves.at(0);
  }
  void expect_glove_rejected(const ImportOptions& options, const std::string& text) {
    try {
      glove(options);
      ADD_FAILURE() << "accepted, instead of " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data);
      EXPECT_NE((std::string(error.what()) + error.hint()).find(text), std::string::npos)
          << error.what() << "; " << error.hint();
    }
    EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
  }
  /// Options that need no frames at rest.
  ImportOptions alone(const std::string& name, int rows, int cols) const {
    ImportOptions options = with_glove(name);
    options.glove.polarity = 1;
    options.glove.layout.rows = rows, options.glove.layout.cols = cols;
    return options;
  }
  /// Imports a glove alone, on any clock.
  GloveStream import_alone(const ImportOptions& options) const {
    import_recording({}, folder_ / "out.h5", options,
                     start_provenance("touchtrace/recording/2", "import"), true);
    return RecordingReader(folder_ / "out.h5").recording().gloves.at(0);
  }
  static void expect_counts(const GloveStream& glove, int frames) {
    ASSERT_EQ(glove.info.rows, 4);
    ASSERT_EQ(glove.info.cols, 3);
    ASSERT_EQ(glove.frames(), std::size_t(frames));
    for (int frame = 0; frame < frames; ++frame)
      for (int i = 0; i < taxels; ++i)
        ASSERT_EQ(glove.counts[std::size_t(frame * taxels + i)], glove_count(frame, i));
    EXPECT_EQ(glove.info.bits, 12);
    EXPECT_EQ(glove.info.polarity, -1);
    EXPECT_NEAR(glove.info.rate_hz, 20.0, 1e-3);
    for (int i = 0; i < taxels; ++i)  // median of three equally frequent counts
      EXPECT_EQ(glove.info.baseline_counts[std::size_t(i)], 3000 + 10 * (i / 3) + i % 3);
  }
};

TEST_F(ImportGlove, WiresensFileHasItsLastFrame) {
  const GloveStream stream = glove(with_glove("wiresens.hdf5"));
  expect_counts(stream, 1500);
  EXPECT_NEAR(stream.host_time_s[1], 0.05, 1e-6);
  EXPECT_NEAR(stream.host_time_s[1499], 1499 / 20.0 + 10.0, 1e-6);
  EXPECT_EQ(stream.sequence[1199], 1199u);
  EXPECT_EQ(stream.sequence[1200], 1400u) << "201 periods later";
  EXPECT_EQ(summary_["glove"]["frames"], 1500u);
  const auto clips = RecordingReader(folder_ / "out.h5").recording().clips;
  ASSERT_EQ(clips.size(), 2u);
  EXPECT_NEAR(clips[0].end_s, 60.0, 1e-5);
  EXPECT_NEAR(clips[1].start_s, 70.0, 1e-5);
  EXPECT_NEAR(clips[1].end_s, 85.0, 1e-5);
}

TEST_F(ImportGlove, RowsThatWereNeverWrittenAreLeftOut) {
  expect_counts(glove(with_glove("early.hdf5")), 1500);
  expect_counts(glove(with_glove("late.hdf5")), 1500);
  auto options = with_glove("open.hdf5");
  options.glove.layout.stream = "tactile-glove-left";
  EXPECT_EQ(glove(options).frames(), 300u);
}

TEST_F(ImportGlove, ActionsenseFileHasTwoGloves) {
  expect_glove_rejected(with_glove("actionsense.hdf5"),
                        "give --glove-stream: tactile-glove-left or tactile-glove-right");
  auto options = with_glove("actionsense.hdf5");
  options.glove.layout.stream = "tactile-glove-right";
  const GloveStream stream = glove(options);
  EXPECT_EQ(stream.info.taxels(), 1024);
  ASSERT_EQ(stream.frames(), 300u);
  EXPECT_EQ(stream.info.polarity, 1);
  EXPECT_EQ(stream.info.bits, 10);
  EXPECT_EQ(stream.counts[1023], 600);
  EXPECT_EQ(stream.counts[81 * 1024], 800 + (7 * 81) % 3);
  EXPECT_EQ(stream.info.baseline_counts[5], 601.0f);
}

TEST_F(ImportGlove, NumpyAndTablesHaveTheSameFrames) {
  expect_counts(glove(with_layout(with_glove("flat.npz"))), 300);
  expect_counts(glove(with_layout(with_glove("plain.csv"))), 300);
  expect_counts(glove(with_layout(with_glove("named.csv"))), 300);
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(with_glove("plain.csv"), "give --rows and --cols");
}

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
  EXPECT_EQ(glove(alone("bool.npz", 4, 3)).counts[0], 1);
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(with_glove("single.npy"), "numpy.savez");
}

TEST_F(ImportGlove, ValuesWithFractionsAreScaledTo16Bits) {
  const auto counts = [&](double low, double high, double baseline) {
    std::string table = "time_s,a,b\n";
    for (int i = 0; i < 60; ++i)
      table += fmt::format("{},{:.5f},{:.5f}\n", 0.05 * i, low, low + (high - low) * i / 59);
    testing::put(folder_ / "a.csv", table);
    auto options = alone("a.csv", 1, 2);
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

TEST_F(ImportGlove, NamesOfColumnsTellTheTaxels) {
  const auto import_names = [&](const std::string& names) {
    std::string table = "time_s," + names + "\n";
    for (int i = 0; i < 60; ++i) table += fmt::format("{},10,20,30,40,50,60\n", 0.05 * i);
    testing::put(folder_ / "a.csv", table);
    return alone("a.csv", 0, 0);
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
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(import_names("0_0,0_1,1_0,1_1,2_0,3_1"), "has no column '2_1'");
  expect_glove_rejected(import_names("0_0,0_1,1_0,1_1,2_0,2_0"), "has two columns '2_0'");
  auto options = import_names("0_0,0_1,1_0,1_1,2_0,2_1");
  options.glove.layout.rows = 2;
  expect_glove_rejected(options, "leave out --rows and --cols");
}

TEST_F(ImportGlove, UnitOfStampsIsThatOfAPlausibleRate) {
  const auto with_stamps = [&](double first, double step, const char* name) {
    std::string table = fmt::format("{},a\n", name);
    for (int i = 0; i < 60; ++i) table += fmt::format("{:.0f},5\n", first + step * i);
    testing::put(folder_ / "a.csv", table);
    return alone("a.csv", 1, 1);
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
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(with_stamps(0.0, 1e11, "timestamp"), "name it with its unit");
  expect_glove_rejected(with_stamps(7.0, 0.0, "timestamp"), "span 0 s");
}

TEST_F(ImportGlove, FramesThatShareAStampAreSpread) {
  std::string table = "time_s,a\n";  // 20 Hz, whole seconds, from the middle of a second on
  for (int i = 10; i < 110; ++i) table += fmt::format("{},5\n", 1700000000 + i / 20);
  testing::put(folder_ / "a.csv", table);
  const GloveStream stream = import_alone(alone("a.csv", 1, 1));
  EXPECT_NEAR(stream.info.rate_hz, 20.0, 1e-6);
  for (std::size_t i = 1; i < 100; ++i)
    EXPECT_NEAR(stream.host_time_s[i] - stream.host_time_s[i - 1], 0.05, 1e-6);
}

TEST_F(ImportGlove, DatesInATableAreTimes) {
  std::string table = "timestamp,a\n";
  for (int i = 0; i < 60; ++i)
    table += fmt::format("2023-11-14T22:13:{:02}.{}+00:00,5\n", 20 + i / 2, i % 2 * 5);
  testing::put(folder_ / "a.csv", table);
  EXPECT_NEAR(import_alone(alone("a.csv", 1, 1)).info.rate_hz, 2.0, 1e-6);
  EXPECT_NEAR(RecordingReader(folder_ / "out.h5").recording().epoch_unix_s, glove_start_s, 1e-5);
}

TEST_F(ImportGlove, ExportedNumbersAreReadBack) {
  std::string table = "time_s,sequence,counts_0_0\n";
  for (int i = 0; i < 60; ++i)
    if (i != 30) table += fmt::format("{},{},5\n", 0.05 * i, 100 + i);
  testing::put(folder_ / "a.csv", table);
  const GloveStream stream = import_alone(alone("a.csv", 1, 1));
  EXPECT_EQ(stream.sequence[30] - stream.sequence[29], 2u);
  EXPECT_EQ(RecordingReader(folder_ / "out.h5").recording().clips.size(), 1u);
  testing::put(folder_ / "a.csv", "time_s,sequence,a\n0,7,1\n0.1,7,1\n0.2,8,1\n0.3,8,1\n");
  EXPECT_EQ(import_alone(alone("a.csv", 1, 1)).sequence.back(), 3u) << "does not count frames";
}

TEST_F(ImportGlove, OptionsReplaceEstimates) {
  auto options = with_glove("wiresens.hdf5");
  options.glove.bits = 14, options.glove.polarity = 1, options.glove.baseline_counts = 7.0;
  options.glove.offset_s = 3600.0;
  import_recording({}, folder_ / "out.h5", options,
                   start_provenance("touchtrace/recording/2", "import"), true);
  const RecordingReader reader(folder_ / "out.h5");
  const GloveStream& stream = reader.recording().gloves.at(0);
  EXPECT_EQ(stream.info.bits, 14);
  EXPECT_EQ(stream.info.polarity, 1);
  EXPECT_EQ(stream.info.baseline_counts[11], 7.0f);
  EXPECT_NEAR(reader.recording().epoch_unix_s, glove_start_s + 3600.0, 1e-5);
}

TEST_F(ImportGlove, JoinsImagesOnTheirClock) {
  write_import_tum(folder_ / "tum");
  const RecordingReader reader = import("tum", with_glove("wiresens.hdf5"));
  const Recording& r = reader.recording();
  EXPECT_EQ(r.camera_times.frames(), std::size_t(import_frames));
  // The images start a quarter of a second after the glove.
  EXPECT_NEAR(r.gloves.at(0).host_time_s[0] - r.camera_times.host_time_s[0], -0.254, 1e-5);
  EXPECT_EQ(r.provenance.inputs.size(), 0u);
}

TEST_F(ImportGlove, ClocksThatDoNotOverlapAreRefused) {
  write_import_tum(folder_ / "tum");
  auto options = with_glove("wiresens.hdf5");
  options.glove.offset_s = 5400.0;
  expect_rejected("tum", "give --glove-offset 0", options);
  options.glove.offset_s = 1e6;
  expect_rejected("tum", "must come from one computer", options);
  options.glove.offset_s = -glove_start_s;  // seconds since the glove's start
  expect_rejected("tum", "do not overlap the images', 1700000000.250", options);
}

TEST_F(ImportGlove, RateIsThatOfFramesInPacketsAndOfLostFrames) {
  std::string table;  // a frame ends with every eighth or ninth packet, by turns; frame 41 is lost
  for (int i = 0, packet = 0; i < 100; ++i, packet += i % 2 == 0 ? 8 : 9)
    if (i != 41) table += fmt::format("{},5\n", glove_start_s + packet / 128.0);
  testing::put(folder_ / "packets.csv", table);
  auto options = with_glove("packets.csv");
  options.glove.polarity = 1;
  // 49 intervals of 9 packets and 48 of 8, without the lost frame's
  EXPECT_NEAR(glove(options).info.rate_hz, 97 * 128.0 / (49 * 9 + 48 * 8), 1e-4);
}

TEST_F(ImportGlove, LocalTimeIsRecognised) {
  write_import_tum(folder_ / "tum");
  std::string table;  // at a place two hours east of Greenwich
  for (int i = 0; i < 60; ++i) table += fmt::format("{},5\n", glove_start_s + 7200.0 + 0.05 * i);
  testing::put(folder_ / "local.csv", table);
  auto options = with_glove("local.csv");
  options.glove.polarity = 1;
  expect_rejected("tum", "give --glove-offset -7200", options);
  options.glove.offset_s = -7200.0;
  EXPECT_EQ(import("tum", options).recording().gloves.at(0).frames(), 60u);
}

TEST_F(ImportGlove, PolarityIsLearntAlsoIfTheGloveIsSqueezedInHalfOfTheTimeAtRest) {
  auto options = with_glove("wiresens.hdf5");
  options.glove.rest_s = 40.0;
  EXPECT_EQ(glove(options).info.polarity, -1);
}

TEST_F(ImportGlove, UnclearPolarityIsRefused) {
  std::string table = "time_s,a,b,c,d\n";  // when squeezed, two taxels rise and two fall
  for (int i = 0; i < 120; ++i) {
    const int change = i < 60 ? 0 : 50;
    table += fmt::format("{},{},{},{},{}\n", glove_start_s + 0.05 * i, 500 + change, 500 - change,
                         500 + change, 500 - change);
  }
  testing::put(folder_ / "a.csv", table);
  expect_glove_rejected(with_glove("a.csv"), "the polarity of the glove is not clear");
  auto options = with_glove("wiresens.hdf5");
  options.glove.rest_s = 0.5;
  expect_glove_rejected(options, "10 glove frames at rest");
}

TEST_F(ImportGlove, BadFilesAreRefused) {
  const auto file = [&](const char* name, const std::string& bytes) {
    testing::put(folder_ / name, bytes);
    return with_glove(name);
  };
  expect_glove_rejected(file("a.csv", "time_s,a\n1,-3\n2,65535\n"), "has the value -3");
  expect_glove_rejected(file("a.csv", "0,5\n1,5\n2,6\n3,6\n"), "column 1 counts the rows");
  auto few_bits = with_glove("wiresens.hdf5");
  few_bits.glove.bits = 10;
  expect_glove_rejected(few_bits, "--bits 10 ends at 1023");
  expect_glove_rejected(file("a.csv", "time_s,a\n1,3\n2,\n"), "has the value nan");
  expect_glove_rejected(file("a.csv", "time_s,a\n1,3\n2,x\n"), "line 3");
  expect_glove_rejected(file("a.csv", "a,b\n1,3\n2,4\n"), "has no column time_s");
  expect_glove_rejected(file("a.csv", "time_s,a\n1,70000\n2,4\n"), "has the value 70000");
  expect_glove_rejected(file("a.bin", "abc"), "is not a file of a tactile glove");
  expect_glove_rejected(with_glove("missing.csv"), "missing.csv is not a file");
  expect_glove_rejected(file("a.npz", "abc"), "not a zip archive");
  std::string h5 = read_file(folder_ / "wiresens.hdf5");
  expect_glove_rejected(file("cut.hdf5", h5.substr(0, h5.size() / 2)), "cut.hdf5");
  write(testing::sample_recording(), folder_ / "r.h5");
  expect_glove_rejected(with_glove("r.h5"), "expected /pressure and /ts (WiReSens)");
}

}  // namespace
}  // namespace touchtrace
