// Numbers in the names of image files.
#include "pipeline/acquire/import/images/named_images.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

class ImportNumbers : public Import {
 protected:
  void write_images(const std::string& kind, const std::vector<int>& numbers,
                    const std::string& prefix = {}) {
    for (const int number : numbers)
      add_file(fmt::format("in/{}/{}{:06}.png", kind, prefix, number),
               encoded(kind == "rgb" ? import_color(0) : import_depth(0, 1000)));
  }
  CameraTimes import_times(double rate_hz = 30.0) {
    return import("in", at_rate(rate_hz)).recording().camera_times;
  }
};

using Numbers = std::vector<std::uint64_t>;

TEST_F(ImportNumbers, EqualNumbersArePairedAndOthersNamed) {
  write_images("rgb", {0, 1, 2, 3}), write_images("depth", {1, 2, 3, 4});
  EXPECT_EQ(import_times().sequence, (Numbers{1, 2, 3}));
  EXPECT_TRUE(warns_of("1 of 4 colour images have no depth image of their number")) << warnings_;
  EXPECT_TRUE(warns_of("numbers 0 to 3 and 1 to 4")) << warnings_;
  write_images("rgb", {4}), write_images("depth", {0});
  EXPECT_EQ(import_times().sequence, (Numbers{0, 1, 2, 3, 4}));
  EXPECT_FALSE(warns_of("number")) << warnings_;
}

TEST_F(ImportNumbers, FoldersWithoutCommonNumbersAreRefused) {
  write_images("rgb", {620, 621, 622}), write_images("depth", {0, 1, 2});
  expect_rejected("in", "no depth image has a colour image at its time", at_rate(30.0));
  expect_rejected("in", "numbers 620 to 622 and 0 to 2", at_rate(30.0));
}

TEST_F(ImportNumbers, MissingImagesAreLostFrames) {
  const std::vector<int> numbers{3, 4, 6, 7, 10, 11, 12};
  write_images("rgb", numbers), write_images("depth", numbers);
  const CameraTimes times = import_times();
  EXPECT_EQ(times.sequence, Numbers(numbers.begin(), numbers.end()));
  EXPECT_NEAR(times.host_time_s[6] - times.host_time_s[0], 9 / 30.0, 1e-9);
}

TEST_F(ImportNumbers, EveryFifthImageIsAFrame) {
  write_images("rgb", {5, 10, 15, 25}), write_images("depth", {5, 10, 15, 25});
  EXPECT_EQ(import_times().sequence, (Numbers{1, 2, 3, 5}));
  EXPECT_FALSE(warns_of("number")) << warnings_;
}

TEST_F(ImportNumbers, TimesInNamesAreNamed) {
  const std::vector<int> stamps{0, 66, 133, 200, 266};
  write_images("rgb", stamps), write_images("depth", stamps);
  EXPECT_EQ(import_times(15.0).sequence, (Numbers{0, 1, 2, 3, 4}));
  EXPECT_TRUE(warns_of("colour images increase by 67, as times in milliseconds do at 14.9 Hz"))
      << warnings_;
}

TEST_F(ImportNumbers, EvenTimesInNamesAreNamedIfTheyFitTheRate) {
  write_images("rgb", {0, 100, 200, 300}), write_images("depth", {0, 100, 200, 300});
  import_times(30.0);
  EXPECT_FALSE(warns_of("milliseconds")) << warnings_;
  import_times(10.0);
  EXPECT_TRUE(warns_of("as times in milliseconds do at 10 Hz")) << warnings_;
}

/// Names in the order that they tell, from the reverse order.
NamedImages ordered(std::vector<std::string> names) {
  std::ranges::reverse(names);
  return order_by_name({names.begin(), names.end()});
}

std::vector<std::string> names_of(const NamedImages& images) {
  return {images.files.begin(), images.files.end()};
}

TEST(NamedImages, NumbersThatAreTheSameInAllNamesDoNotCount) {
  const std::vector<std::string> names{"frame_2_640x480.png", "frame_10_640x480.png"};
  const NamedImages images = ordered(names);
  EXPECT_EQ(names_of(images), names);
  EXPECT_EQ(images.numbers, (std::vector<double>{2, 10}));
}

TEST(NamedImages, DatesAreTimes) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"2026-03-04_10-15-59_313.png", "2026-03-04_10-16-00_013.png"},
        {"2026-03-04 10:15:59.313000.png", "2026-03-04 10:16:00.013000.png"},
        {"rgb_20260304T101559.313.png", "rgb_20260304T101600.013.png"},
        {"20260304101559313000.png", "20260304101600013000.png"}}) {
    const NamedImages images = ordered(names);
    EXPECT_EQ(names_of(images), names);
    ASSERT_EQ(images.stamps.size(), 2u) << names[0];
    EXPECT_NEAR(images.stamps[0], 1772619359.313, 1e-6) << names[0];
    EXPECT_NEAR(images.stamps[1] - images.stamps[0], 0.7, 1e-6) << names[0];
  }
}

TEST(NamedImages, NumbersThatDisagreeAreNotNumbersOfFrames) {
  const std::vector<std::string> names{"10_59_313.png", "10_59_346.png", "11_00_013.png"};
  const NamedImages images = ordered(names);
  EXPECT_EQ(names_of(images), names);
  EXPECT_TRUE(images.numbers.empty());
  EXPECT_TRUE(images.stamps.empty());
  EXPECT_TRUE(images.numbers_disagree);
}

TEST(NamedImages, StampsAreNoDates) {
  EXPECT_EQ(ordered({"1700000000123.png", "1700000000456.png"}).stamps[1], 1700000000456.0);
  EXPECT_EQ(ordered({"7_1700000000.123.png", "8_1700000000.456.png"}).stamps[0], 1700000000.123);
  EXPECT_TRUE(ordered({"a.png", "b.png"}).numbers.empty());
  EXPECT_EQ(ordered({"1.png"}).numbers, std::vector<double>{1});
}

TEST_F(ImportNumbers, AListMayCountItsLines) {
  write_images("rgb", {0, 1, 2}), write_images("depth", {0, 1, 2});
  for (const auto& [list, duration_s] :
       {std::pair{"0 7.00\n1 7.05\n2 7.10\n", 0.1},  // numbers, times
        {"0 0.01\n1 0.01\n2 0.01\n", 2.0},           // times, exposures
        {"0 a.png\n1 b.png\n2 c.png\n", 2.0}}) {
    testing::put(folder_ / "in" / "times.txt", list);
    const CameraTimes times = import_times(0.0);
    EXPECT_NEAR(times.host_time_s[2] - times.host_time_s[0], duration_s, 1e-9) << list;
  }
}

TEST_F(ImportNumbers, ACounterBehindADateIsNoTimeIfThereIsARate) {
  for (const char* kind : {"rgb", "depth"}) write_images(kind, {0, 1, 2}, "20240101_");
  CameraTimes times = import_times(20.0);
  EXPECT_NEAR(times.host_time_s[2] - times.host_time_s[0], 0.1, 1e-9);
  times = import_times(0.0);
  EXPECT_NEAR(times.host_time_s[2] - times.host_time_s[0], 2.0, 1e-6);
}

}  // namespace
}  // namespace touchtrace
