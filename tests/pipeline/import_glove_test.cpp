#include "tests/pipeline/import_glove_samples.h"

namespace touchtrace {
namespace {

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
  expect_glove_rejected(with_glove("plain.csv"), "give --rows and --cols");
}

TEST_F(ImportGlove, AnArchiveWithoutTimesNeedsARate) {
  auto options = with_glove("timeless.npz");
  expect_glove_rejected(options, "has no array time_s");
  options.source.rate_hz = 20.0;
  expect_counts(import_alone(options), 300);
}

TEST_F(ImportGlove, AFrameOfAnArchiveWithoutAValueIsLost) {
  const GloveStream stream = glove(with_glove("gap.npz"));
  EXPECT_EQ(stream.frames(), 299u);
  EXPECT_EQ(stream.sequence[120], 121u);
}

TEST_F(ImportGlove, OptionsReplaceEstimates) {
  auto options = with_glove("wiresens.hdf5");
  options.glove.bits = 14, options.glove.polarity = 1, options.glove.baseline_counts = 7.0;
  options.glove.offset_s = 3600.0;
  const RecordingReader reader = import({}, options);
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
  // at a place two hours east of Greenwich, from eight minutes before the images
  std::string table;
  for (int i = 0; i < 6000; ++i)
    table += fmt::format("{},5\n", glove_start_s + 7200.0 - 480.0 + 0.1 * i);
  testing::put(folder_ / "local.csv", table);
  auto options = with_glove("local.csv");
  options.glove.polarity = 1;
  expect_rejected("tum", "give --glove-offset -7200", options);
  options.glove.offset_s = -7200.0;
  EXPECT_EQ(import("tum", options).recording().gloves.at(0).frames(), 6000u);
}

TEST_F(ImportGlove, PolarityIsLearntAlsoIfTheGloveIsSqueezedInHalfOfTheTimeAtRest) {
  auto options = with_glove("wiresens.hdf5");
  options.glove.rest_s = 40.0;
  EXPECT_EQ(glove(options).info.polarity, -1);
}

TEST_F(ImportGlove, UnclearPolarityIsRefused) {
  const auto row = [](int i) {  // when squeezed, two taxels rise and two fall
    const int high = i < 60 ? 500 : 550, low = 1000 - high;
    return fmt::format("{},{},{},{},{}\n", glove_start_s + 0.05 * i, high, low, high, low);
  };
  table("time_s,a,b,c,d\n", row, 0, 0, 120);
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
  expect_glove_rejected(file("a.csv", "0,5\n1,5\n2,6\n3,6\n"), "column 1 counts the rows");
  auto few_bits = with_glove("wiresens.hdf5");
  few_bits.glove.bits = 10;
  expect_glove_rejected(few_bits, "--bits 10 ends at 1023");
  expect_glove_rejected(file("a.csv", "time_s,a\n1,3\n2,\n"), "1 of 2 rows have no value");
  expect_glove_rejected(file("a.csv", "time_s,a\n1,3\n2,x\n"), "line 3");
  expect_glove_rejected(file("a.csv", "a,b\n1,3\n2,4\n"), "has no column time_s");
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
