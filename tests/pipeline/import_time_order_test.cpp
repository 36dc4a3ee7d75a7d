// Image times that run backward.
#include <numeric>

#include "pipeline/acquire/time_order.h"
#include "tests/export/python.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

constexpr double period_s = 1.0 / 30.0;
using Order = std::vector<std::size_t>;

std::vector<double> regular_times(std::size_t count) {
  std::vector<double> times_s(count);
  for (std::size_t i = 0; i < count; ++i) times_s[i] = import_start_s + period_s * double(i);
  return times_s;
}

/// Warnings of time_order(), whose result is stored in `order`.
std::string warnings(const std::vector<double>& times_s, Order& order) {
  Progress::silence();
  ::testing::internal::CaptureStderr();
  order = time_order(times_s, "list");
  return ::testing::internal::GetCapturedStderr();
}

void expect_order_fault(const std::vector<double>& times_s, const std::string& fault) {
  testing::expect_error([&] { time_order(times_s, "list"); }, fault + "; ");
}

TEST(TimeOrder, SaysNothingOfOrderedTimes) {
  Order order;
  EXPECT_EQ(warnings({1.0, 2.0, 2.0, 3.0}, order), "");
  EXPECT_EQ(order, (Order{0, 1, 2, 3}));
  EXPECT_EQ(warnings({}, order), "");
}

TEST(TimeOrder, SortsASwappedPairAndALateImage) {
  auto times_s = regular_times(30);
  std::swap(times_s[9], times_s[10]);
  Order order;
  EXPECT_NE(warnings(times_s, order)
                .find("warning: list: the times of 1 of 30 images run backward, first of image 11: "
                      "1700000000.550 s after 1700000000.583 s; images are sorted by time"),
            std::string::npos);
  EXPECT_EQ(order[9], 10u);
  EXPECT_EQ(order[10], 9u);
  times_s = regular_times(30);
  std::rotate(times_s.begin() + 4, times_s.begin() + 5, times_s.begin() + 25);
  EXPECT_NE(warnings(times_s, order).find("first of image 25"), std::string::npos);
  EXPECT_EQ(order[4], 24u);
}

TEST(TimeOrder, SortsAListInAnyOrder) {
  auto times_s = regular_times(60);
  RandomStream random(1, "shuffled list");
  for (std::size_t i = times_s.size(); i > 1; --i)
    std::swap(times_s[i - 1], times_s[random.below(i)]);
  Order order;
  EXPECT_NE(warnings(times_s, order).find("of 60 images run backward"), std::string::npos);
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_LT(times_s[order[i - 1]], times_s[order[i]]);
}

TEST(TimeOrder, RefusesAClockThatWasSetBack) {
  for (const double step_s : {0.15, 2.0, 3600.0}) {
    auto times_s = regular_times(60);
    for (std::size_t i = 20; i < 60; ++i) times_s[i] -= step_s;
    expect_order_fault(times_s,
                       fmt::format("list: the times of 1 of 60 images run backward, the clock "
                                   "was set back before image 21: {:.3f} s after {:.3f} s",
                                   times_s[20], times_s[19]));
  }
}

TEST(TimeOrder, RefusesTimesThatAreNotFinite) {
  expect_order_fault({1.0, std::nan("")}, "list: image 2 has the time nan");
}

class ImportTimeOrder : public Import {
 protected:
  /// `count` images; times.txt has `times_s`.
  void write_images(const std::vector<double>& times_s) {
    std::string list;
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      add_file(fmt::format("in/rgb/{}.png", i), encoded(import_color(int(i))));
      add_file(fmt::format("in/depth/{}.png", i), encoded(import_depth(int(i), 1000)));
      list += fmt::format("{:.6f}\n", times_s[i]);
    }
    add_file("in/times.txt", list);
  }
};

TEST_F(ImportTimeOrder, FolderIsSortedWithAWarning) {
  auto times_s = regular_times(12);
  std::swap(times_s[5], times_s[6]);
  write_images(times_s);
  const RecordingReader reader = import("in");
  EXPECT_TRUE(warns_of("rgb: the times of 1 of 12 images run backward")) << warnings_;
  EXPECT_EQ(reader.read_camera_frame(5).color[3], 106);
}

TEST_F(ImportTimeOrder, FolderOfAClockThatWasSetBackIsRefused) {
  auto times_s = regular_times(20);
  for (std::size_t i = 10; i < 20; ++i) times_s[i] -= 0.2;
  write_images(times_s);
  expect_rejected("in", "the clock was set back before image 11");
}

TEST_F(ImportTimeOrder, ArchiveIsSortedAndItsTimesMayBeMilliseconds) {
  testing::expect_python(
      folder_.path(),
      "c = np.zeros((12, 6, 8, 3), np.uint8)\nc[:, 0, 1, 0] = 100 + np.arange(12)\n"
      "t = np.arange(12) * 33.0\nt[[5, 6]] = t[[6, 5]]\n"
      "np.savez('in.npz', color=c, depth=np.full((12, 6, 8), 1000, np.uint16), timestamps=t)");
  const RecordingReader reader = import("in.npz");
  EXPECT_TRUE(warns_of("color: the times of 1 of 12 images run backward")) << warnings_;
  EXPECT_EQ(reader.read_camera_frame(5).color[3], 106);
  EXPECT_NEAR(reader.recording().camera_times.host_time_s[11], 0.363, 1e-6);
}

}  // namespace
}  // namespace touchtrace
