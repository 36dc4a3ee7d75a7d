// Tables as other programs write them.
#include "tests/pipeline/import_glove_samples.h"

namespace touchtrace {
namespace {

constexpr int num_rows = 40;

/// Twelve values, of which one changes.
std::string row_of_values(int row) {
  std::string text;
  for (int i = 0; i < 12; ++i) text += fmt::format(",{}", i == 3 ? 40 + row % 2 : 10 + i);
  return text + "\n";
}

TEST_F(ImportGlove, ClocksAndCountersAreNotTaxels) {
  const auto row = [](int i) {  // VMG30: milliseconds, seconds of another clock, values
    return fmt::format("{}, {:.6f}", 4680 + 10 * i, 4.789 + 0.01 * i) + row_of_values(i);
  };
  const GloveStream stream = import_alone(table("", row, 4, 3));
  EXPECT_TRUE(warns_of("warning: glove: skipped 'column 2'")) << warnings_;
  EXPECT_EQ(stream.counts[0], 10);
  EXPECT_EQ(stream.counts[12 * 5 + 3], 41);
  EXPECT_NEAR(stream.info.rate_hz, 100.0, 1e-3);
  EXPECT_EQ(import_alone(alone("a.csv", 1, 13)).info.cols, 13) << "the layout needs the column";
}

TEST_F(ImportGlove, LinesBeforeATableAreSkipped) {
  std::string header = "##Session\nschema_version,1\nrows,13\ndevice_alias,\n##Data\n";
  header += "timestamp,elapsed,frame_index";
  for (int i = 0; i < 12; ++i) header += fmt::format(",ch{}", i);
  const auto row = [](int i) {
    return fmt::format("{:.6f},{:.6f},{}", 621301.629 + 0.1 * i, 0.1 * i, i) + row_of_values(i);
  };
  const GloveStream stream = import_alone(table(header + "\n", row, 4, 3));
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.counts[11], 21);
  EXPECT_NEAR(stream.info.rate_hz, 10.0, 1e-3);
}

TEST_F(ImportGlove, NumberedColumnsThatFitAreTheTaxels) {
  const auto expect_sensors = [&](const ImportOptions& options, bool is_guess) {
    const GloveStream stream = import_alone(options);
    EXPECT_EQ(warns_of("only s_0 to s_15 are taken for taxels"), is_guess) << warnings_;
    EXPECT_EQ(stream.info.rows, 4);
    EXPECT_EQ(stream.counts[0], 10);
    EXPECT_EQ(stream.counts[16 * 3 + 15], 41);
    EXPECT_NEAR(stream.info.rate_hz, 20.0, 1e-2);
  };
  std::string names = "pc_ts,index avg";
  for (int i = 0; i < 16; ++i) names += fmt::format(",s_{}", i);
  const auto row = [](int row) {  // of which the last of 16 sensors changes
    std::string text = fmt::format("{:.3f},7", 1770000000.5 + 0.05 * row);
    for (int i = 0; i < 16; ++i) text += fmt::format(",{}", i == 15 ? 40 + row % 2 : 10 + i);
    return text + ",1,2,3\n";
  };
  expect_sensors(table(names + ",X,Y,Z\n", row), true);
  expect_sensors(alone("a.csv", 4, 4), true);
  auto chosen = alone("a.csv", 4, 4);
  chosen.glove.layout.taxels = "s 0:s_15";
  expect_sensors(chosen, false);
  chosen.glove.layout.taxels = "3:18";
  expect_sensors(chosen, false);
  expect_glove_rejected(alone("a.csv", 5, 5), "index_avg, s_0 to s_15, x, y, z");
  for (const char* wrong : {"s_0", "s_0:s_16", "0:3", "18:3"}) {
    chosen.glove.layout.taxels = wrong;
    EXPECT_THROW(import_alone(chosen), Error) << wrong;
  }
}

TEST_F(ImportGlove, AFirstColumnThatIsNoClockIsASensor) {
  auto options = table("", [](int i) { return fmt::format("{},6,7,8,9,{}\n", 5 + i % 2, i % 3); });
  options.source.rate_hz = 20.0;
  expect_glove_rejected(options, "6 values per frame are not a square");
  options.glove.layout.rows = 2;
  EXPECT_EQ(import_alone(options).info.cols, 3);
}

TEST_F(ImportGlove, TablesWithoutTimesNeedARate) {
  auto options = table("left_1,left_2,left_3,right_1\n",
                       [](int i) { return fmt::format("5,6,7,{}\n", i % 3); });
  expect_glove_rejected(options, "without times give --rate HZ");
  options.source.rate_hz = 50.0;
  const GloveStream stream = import_alone(options);
  EXPECT_EQ(stream.info.rows, 2);
  EXPECT_NEAR(stream.host_time_s[39], 39 / 50.0, 1e-9);
  for (const char* name : {"a.txt", "a.tsv", "a.log", "a.dat"}) {
    fs::copy(folder_ / "a.csv", folder_ / name);
    auto other = alone(name, 2, 2);
    other.source.rate_hz = 50.0;
    EXPECT_EQ(import_alone(other).counts, stream.counts) << name;
  }
}

TEST_F(ImportGlove, TablesWithoutNamesAndTimesNeedARateAndALayout) {
  auto options = table(  // as numpy.savetxt and spreadsheets write them
      "", [](int i) { return fmt::format("5\t6\t7\t{}\t\n", i % 3); }, 2, 2);
  options.source.rate_hz = 50.0;
  const GloveStream stream = import_alone(options);
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.counts[4 * 5 + 3], 2);
  EXPECT_NEAR(stream.host_time_s[39], 39 / 50.0, 1e-9);
}

TEST_F(ImportGlove, TheFirstRowMayNumberTheColumns) {
  std::string names;  // as pandas writes a table without names
  for (int i = 0; i < 12; ++i) names += fmt::format(",{}", i);
  const auto row = [](int i) { return fmt::format("{:.2f}", 0.02 * i) + row_of_values(i); };
  for (const std::string& header : {"time_s" + names, "time_s" + names + ",", std::string()}) {
    const GloveStream stream = import_alone(table(header + "\n", row, 4, 3));
    EXPECT_EQ(stream.frames(), std::size_t(num_rows)) << header;
    EXPECT_EQ(stream.counts[11], 21) << header;
  }
  auto options = table(
      names.substr(1) + "\n", [](int i) { return row_of_values(i).substr(1); }, 4, 3);
  options.source.rate_hz = 50.0;
  EXPECT_EQ(import_alone(options).frames(), std::size_t(num_rows));
}

TEST_F(ImportGlove, RowsMayEndWithASeparatorAndTheLastOneMayBeCutOff) {
  std::string table = "time_s|0_0|0_1|1_0|1_1\n";
  for (int i = 0; i < num_rows; ++i) table += fmt::format("{:.2f}|5|6|7|{}|\n", 0.02 * i, i % 3);
  testing::put(folder_ / "a.LOG", table + "0.80|5|6");
  EXPECT_EQ(import_alone(alone("a.LOG", 0, 0)).frames(), std::size_t(num_rows));
}

TEST_F(ImportGlove, ARowOfUnitsIsNotAFrame) {
  const auto row = [](int i) { return fmt::format("{:.2f},5,6,7,{}\n", 0.02 * i, i % 3); };
  const auto options = table("time_s,0_0,0_1,1_0,1_1\ns,kPa,kPa,kPa,kPa\n", row);
  EXPECT_EQ(import_alone(options).frames(), std::size_t(num_rows));
}

TEST_F(ImportGlove, AFrameWithoutAValueIsLeftOut) {
  const GloveStream stream = import_alone(table("time_s,0_0,0_1,1_0,1_1\n", [](int i) {
    return fmt::format("{:.2f},5,6,{},{}\n", 0.02 * i, i == 7 ? "" : "7", i % 3);
  }));
  EXPECT_EQ(stream.frames(), std::size_t(num_rows - 1));
  EXPECT_NEAR(stream.host_time_s[7], 0.16, 1e-9);
  EXPECT_EQ(stream.sequence[7], 8u) << "regular stamps count missing frames";
}

TEST_F(ImportGlove, NamesTellThePlacesOfTaxels) {
  const GloveStream stream = import_alone(table(  // column by column
      "time_s,p_0_0,p_1_0,p_0_1,p_1_1,p_0_2,p_1_2\n",
      [](int i) { return fmt::format("{:.2f},1,2,3,4,5,{}\n", 0.02 * i, i % 3); }));
  EXPECT_EQ(stream.info.rows, 2);
  EXPECT_EQ(stream.counts[1], 3);
  EXPECT_EQ(stream.counts[3], 2);
  expect_glove_rejected(alone("a.csv", 3, 2), "named for 2 x 3 taxels");
}

TEST_F(ImportGlove, RepeatedNumbersKeepTheOrderOfTheFile) {
  const auto row = [](int i) {
    return fmt::format("{:.2f},10,11,12,13,20,21,22,{}\n", 0.05 * i, 40 + i % 2);
  };
  // Two sensors, next to each other.
  const GloveStream stream = import_alone(table("time_s,1,2,3,4,1,2,3,4\n", row, 2, 4));
  for (std::size_t taxel = 0; taxel < 7; ++taxel)
    EXPECT_EQ(stream.counts[taxel], taxel < 4 ? 10 + taxel : 16 + taxel);
}

TEST_F(ImportGlove, AnIndexThatDoesNotCountIsAFinger) {
  const auto row = [](int i) { return fmt::format("{:.2f},10,{},12,13\n", 0.05 * i, 40 + i % 2); };
  EXPECT_EQ(import_alone(table("time_s,thumb,index,middle,ring\n", row, 2, 2)).counts[1], 40);
}

/// A first row that is cut off does not name the columns.
TEST_F(ImportGlove, RowsMayBeginInTheMiddle) {
  const auto row = [](int i) { return fmt::format("{:.2f},{},5,6,7,8,9\n", 0.05 * i, 1 + i % 3); };
  const GloveStream stream = import_alone(table("5,6,0.5\n", row, 2, 3));
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.counts[6], 2);
}

/// Without names and a rate: column 1, if it can be a time; times since 1970 in any column, which
/// are not among the taxels.
TEST_F(ImportGlove, PressuresAreNotTimes) {
  const auto pressures = [](int i) { return fmt::format("{},{},7,8,9\n", i % 7, 10 + i % 3); };
  expect_glove_rejected(table("", pressures, 2, 2), "give --rate HZ");
  auto chosen = table(
      "", [](int i) { return fmt::format("{},{:.2f}\n", 100 + i, glove_start_s + 0.05 * i); }, 1,
      1);
  chosen.glove.layout.taxels = "1:1";
  const GloveStream stream = glove(chosen);
  EXPECT_EQ(stream.counts[3], 103);
  EXPECT_NEAR(stream.info.rate_hz, 20.0, 1e-3);
}

/// One frame in fifty is touched, less than the fraction in which a squeezed glove is.
TEST_F(ImportGlove, SeldomTouchesTellThePolarity) {
  const auto row = [](int i) {
    return fmt::format("{:.2f},{},7\n", 0.05 * i, i > 60 && i % 50 == 0 ? 300 : 800 + i % 2);
  };
  auto options = table("time_s,0_0,0_1\n", row, 1, 2, 400);
  options.glove.polarity = 0;
  EXPECT_EQ(import_alone(options).info.polarity, -1);
}

TEST_F(ImportGlove, NamesOfTimesMayVary) {
  for (const char* name :
       {"Measurement Time (sec)", "elapsed_s", "time_sec", "datetime", "seconds"}) {
    const auto row = [](int i) { return fmt::format("{:.2f},{},6\n", 0.05 * i, 5 + i % 3); };
    const GloveStream stream = import_alone(table(std::string(name) + ",0_0,0_1\n", row, 1, 2));
    EXPECT_EQ(stream.frames(), std::size_t(num_rows)) << name;
    EXPECT_NEAR(stream.info.rate_hz, 20.0, 1e-3) << name;
  }
}

TEST_F(ImportGlove, TextIsNotATaxel) {
  const auto row = [](int i) {
    return fmt::format("{:.2f},{},5,6,7,{},{}\n", 0.02 * i, i % 2 ? "forward" : "back", 1 + i % 3,
                       i == 9 ? "slipped" : "");
  };
  const GloveStream stream = import_alone(table("time_s,direction,0_0,0_1,1_0,1_1,note\n", row));
  EXPECT_TRUE(warns_of("skipped 'direction', 'note': text")) << warnings_;
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.info.rows, 2);
  EXPECT_EQ(stream.counts[3], 1);
  EXPECT_EQ(stream.counts[4 * 5 + 3], 3);
}

TEST_F(ImportGlove, TextAmongNumbersIsAFault) {
  const auto row = [](int i) {
    return fmt::format("{:.2f},5,6,7,{}\n", 0.02 * i, i == 30 ? "bad" : "8");
  };
  expect_glove_rejected(table("", row, 2, 2), "line 31: column 5 'bad' is not a number");
}

TEST_F(ImportGlove, LargeWholeValuesAreScaled) {
  const auto row = [](int i) { return fmt::format("{:.2f},{}\n", 0.02 * i, 5000 * i); };
  const GloveStream stream = import_alone(table("time_s,0_0\n", row, 1, 1));  // up to 195000 < 2^18
  EXPECT_EQ(stream.info.bits, 16);
  EXPECT_NEAR(stream.counts[39], 195000.0 * 65535.0 / 262144.0, 1.0);
}

TEST_F(ImportGlove, OptionsWithoutEffectAreRefused) {
  const auto with = [&](auto set) {
    ImportOptions options = alone("wiresens.hdf5", 0, 0);
    set(options.glove);
    return options;
  };
  EXPECT_NO_THROW(import_alone(with([](auto&) {})));
  expect_rejected({}, "--baseline -0.5 is not a count",
                  with([](GloveOptions& o) { o.baseline_counts = -0.5; }), ExitCode::usage);
  expect_rejected({}, "a glove that is never at rest needs a baseline",
                  with([](GloveOptions& o) { o.rest_s = 0.0; }), ExitCode::usage);
  expect_rejected({}, "has one glove", with([](GloveOptions& o) { o.layout.stream = "right"; }));
  expect_rejected({}, "has 4 x 3 taxels, not 3 x 4", alone("fraction.npz", 3, 4));
  testing::put(folder_ / "lfs.csv", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n");
  expect_rejected({}, "Git LFS", alone("lfs.csv", 0, 0));
}

TEST_F(ImportGlove, TimesFromZeroLoseNoFrame) {
  const GloveStream stream = import_alone(with_glove("relative.hdf5"));
  EXPECT_EQ(stream.frames(), 1500u);
  EXPECT_EQ(stream.counts[1], glove_count(0, 1));
}

}  // namespace
}  // namespace touchtrace
