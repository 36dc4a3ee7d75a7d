// Stamps and counters of tables.
#include "tests/pipeline/import_glove_samples.h"

namespace touchtrace {
namespace {

constexpr int num_rows = 40;
const std::string taxel_names = ",0_0,0_1,1_0,1_1\n";

TEST_F(ImportGlove, IrregularStampsCountNoMissingFrames) {
  const auto row = [](int i) {  // packets of two frames
    return fmt::format("{:.3f},5,6,7,{}\n", 0.02 * i + (i % 2 ? 0.0 : 0.01), i % 3);
  };
  EXPECT_EQ(import_alone(table("time_s" + taxel_names, row)).sequence.back(),
            std::uint64_t(num_rows - 1));
}

TEST_F(ImportGlove, AUnitInTheNameIsNotQuestioned) {
  for (const auto& [name, interval_s] : {std::pair{"time_s", 5.0}, {"time", 0.005}}) {
    const auto row = [](int i) { return fmt::format("{},5,6,7,{}\n", 5 * i, i % 3); };
    const GloveStream stream = import_alone(table(name + taxel_names, row));
    EXPECT_NEAR(stream.host_time_s[1], interval_s, 1e-9) << name;
  }
}

TEST_F(ImportGlove, TimesOfTheDayAreRead) {
  const GloveStream stream = import_alone(table("time" + taxel_names, [](int i) {
    return fmt::format("10:15:{:02}.{}0,5,6,7,{}\n", 50 + i / 4 % 10, 2 * (i % 4), i % 3);
  }));
  const double start_s = 36950.0;  // 10:15:50
  EXPECT_NEAR(stream.host_time_s[1], start_s + 0.2, 1e-6);
  EXPECT_NEAR(stream.host_time_s[39], start_s + 9.6, 1e-6);
}

TEST_F(ImportGlove, AWrongStampCostsOneFrame) {
  const GloveStream stream = import_alone(table("time_us" + taxel_names, [](int i) {
    return fmt::format("{},5,6,7,{}\n", i == 20 ? 900'000'000 : 20'000 * i, i % 3);
  }));
  EXPECT_EQ(stream.frames(), std::size_t(num_rows - 1));
  EXPECT_NEAR(stream.host_time_s.back(), 0.02 * (num_rows - 1), 1e-9);
}

TEST_F(ImportGlove, LostFramesOfATableWithoutTimesTakeTime) {
  auto options = table("sequence" + taxel_names, [](int i) {
    return i % 10 == 4 ? "" : fmt::format("{},5,6,7,{}\n", 100 + i, i % 3);
  });
  options.source.rate_hz = 50.0;
  const GloveStream stream = import_alone(options);
  EXPECT_NEAR(stream.host_time_s.back(), 0.02 * (num_rows - 1), 1e-9);
  EXPECT_NEAR(stream.host_time_s[4], 0.1, 1e-9);
}

TEST_F(ImportGlove, SwappedRowsAreSorted) {
  const GloveStream stream = import_alone(table("time_ms" + taxel_names, [](int i) {
    const int row = i == 0 ? 1 : i == 1 ? 0 : i == 20 ? 21 : i == 21 ? 20 : i;
    return fmt::format("{},5,6,7,{}\n", 20 * row, row);
  }));
  ASSERT_EQ(stream.frames(), std::size_t(num_rows));
  for (const int row : {0, 1, 2, 19, 20, 21, 22}) {
    EXPECT_NEAR(stream.host_time_s[std::size_t(row)], 0.02 * row, 1e-9);
    EXPECT_EQ(stream.counts[std::size_t(4 * row + 3)], row);
  }
}

TEST_F(ImportGlove, ACounterOfMicrosecondsMayStartAgain) {
  for (const char* name : {"time_us", "time"}) {
    const GloveStream stream = import_alone(table(name + taxel_names, [](int i) {
      return fmt::format("{},5,6,7,{}\n", (4'294'900'000u + 20'000u * unsigned(i)) % (1ull << 32),
                         i % 3);
    }));
    EXPECT_EQ(stream.frames(), std::size_t(num_rows)) << name;
    EXPECT_NEAR(stream.info.rate_hz, 50.0, 1e-3) << name;
  }
}

}  // namespace
}  // namespace touchtrace
