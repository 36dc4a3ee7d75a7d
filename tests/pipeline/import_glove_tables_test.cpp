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
  std::string table;  // VMG30: milliseconds, seconds of another clock, values
  for (int i = 0; i < num_rows; ++i)
    table += fmt::format("{}, {:.6f}", 4680 + 10 * i, 4.789 + 0.01 * i) + row_of_values(i);
  testing::put(folder_ / "a.txt", table);
  ::testing::internal::CaptureStderr();
  const GloveStream stream = import_alone(alone("a.txt", 4, 3));
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("warning: glove: left out 'column 2'"), std::string::npos) << text;
  EXPECT_EQ(stream.counts[0], 10);
  EXPECT_EQ(stream.counts[12 * 5 + 3], 41);
  EXPECT_NEAR(stream.info.rate_hz, 100.0, 1e-3);
  EXPECT_EQ(import_alone(alone("a.txt", 1, 13)).info.cols, 13) << "the layout needs the column";
}

TEST_F(ImportGlove, LinesBeforeATableAreSkipped) {
  std::string table = "##Session\nschema_version,1\nrows,13\ndevice_alias,\n##Data\n";
  table += "timestamp,elapsed,frame_index";
  for (int i = 0; i < 12; ++i) table += fmt::format(",ch{}", i);
  table += "\n";
  for (int i = 0; i < num_rows; ++i)
    table += fmt::format("{:.6f},{:.6f},{}", 621301.629 + 0.1 * i, 0.1 * i, i) + row_of_values(i);
  testing::put(folder_ / "a.csv", table);
  const GloveStream stream = import_alone(alone("a.csv", 4, 3));
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.counts[11], 21);
  EXPECT_NEAR(stream.info.rate_hz, 10.0, 1e-3);
}

TEST_F(ImportGlove, TablesWithoutTimesNeedARate) {
  std::string table = "left_1,left_2,left_3,right_1\n";
  for (int i = 0; i < num_rows; ++i) table += fmt::format("5,6,7,{}\n", i % 3);
  testing::put(folder_ / "a.csv", table);
  auto options = alone("a.csv", 0, 0);
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(options, "without times give --rate HZ");
  options.source.rate_hz = 50.0;
  const GloveStream stream = import_alone(options);
  EXPECT_EQ(stream.info.rows, 2);
  EXPECT_NEAR(stream.host_time_s[39], 39 / 50.0, 1e-9);
}

TEST_F(ImportGlove, TextIsNotATaxel) {
  std::string table = "time_s,direction,0_0,0_1,1_0,1_1,note\n";
  for (int i = 0; i < num_rows; ++i)
    table += fmt::format("{:.2f},{},5,6,7,{},{}\n", 0.02 * i, i % 2 ? "forward" : "back", 1 + i % 3,
                         i == 9 ? "slipped" : "");
  testing::put(folder_ / "a.csv", table);
  ::testing::internal::CaptureStderr();
  const GloveStream stream = import_alone(alone("a.csv", 0, 0));
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("left out 'direction', which is text"), std::string::npos) << text;
  EXPECT_NE(text.find("left out 'note', which is text"), std::string::npos) << text;
  EXPECT_EQ(stream.frames(), std::size_t(num_rows));
  EXPECT_EQ(stream.info.rows, 2);
  EXPECT_EQ(stream.counts[3], 1);
  EXPECT_EQ(stream.counts[4 * 5 + 3], 3);
}

TEST_F(ImportGlove, TextAmongNumbersIsAFault) {
  std::string table;
  for (int i = 0; i < num_rows; ++i)
    table += fmt::format("{:.2f},5,6,7,{}\n", 0.02 * i, i == 30 ? "bad" : "8");
  testing::put(folder_ / "a.csv", table);
  fs::remove(folder_ / "out.h5");
  expect_glove_rejected(alone("a.csv", 2, 2), "line 31: column 5 'bad' is not a number");
}

}  // namespace
}  // namespace touchtrace
