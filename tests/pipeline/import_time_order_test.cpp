// Image times that run backward.
#include <numeric>

#include "engine/base/random.h"
#include "pipeline/acquire/time_order.h"
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

std::string fault(const std::vector<double>& times_s) {
  try {
    time_order(times_s, "list");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::data);
    return error.what();
  }
  return "accepted";
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
    EXPECT_EQ(fault(times_s),
              fmt::format("list: the times of 1 of 60 images run backward, the clock was set back "
                          "before image 21: {:.3f} s after {:.3f} s",
                          times_s[20], times_s[19]));
  }
}

TEST(TimeOrder, RefusesTimesThatAreNotFinite) {
  EXPECT_EQ(fault({1.0, std::nan("")}), "list: image 2 has the time nan");
}

class ImportTimeOrder : public Import {
 protected:
  /// `count` images; times.txt has `times_s`.
  void write_images(const std::vector<double>& times_s) {
    std::string list;
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const std::string name = fmt::format("{}.png", i);
      write_file(folder_ / "in" / "rgb" / name, encoded(import_color(int(i))), true);
      write_file(folder_ / "in" / "depth" / name, encoded(import_depth(int(i), 1000)), true);
      list += fmt::format("{:.6f}\n", times_s[i]);
    }
    write_file(folder_ / "in" / "times.txt", list, true);
  }
};

TEST_F(ImportTimeOrder, FolderIsSortedWithAWarning) {
  auto times_s = regular_times(12);
  std::swap(times_s[5], times_s[6]);
  write_images(times_s);
  ::testing::internal::CaptureStderr();
  const RecordingReader reader = import("in");
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("rgb: the times of 1 of 12 images run backward"), std::string::npos) << text;
  EXPECT_EQ(reader.read_camera_frame(5).color[3], 106);
}

TEST_F(ImportTimeOrder, FolderOfAClockThatWasSetBackIsRefused) {
  auto times_s = regular_times(20);
  for (std::size_t i = 10; i < 20; ++i) times_s[i] -= 0.2;
  write_images(times_s);
  expect_rejected("in", "the clock was set back before image 11");
}

TEST_F(ImportTimeOrder, ArchiveIsSortedAndItsTimesMayBeMilliseconds) {
  const std::string command =
      "/usr/bin/python3 -c \"import numpy as np; c = np.zeros((12, 6, 8, 3), np.uint8); "
      "c[:, 0, 1, 0] = 100 + np.arange(12); t = np.arange(12) * 33.0; t[[5, 6]] = t[[6, 5]]; "
      "np.savez('" +
      (folder_ / "in.npz").string() +
      "', color=c, depth=np.full((12, 6, 8), 1000, np.uint16), timestamps=t)\"";
  ASSERT_EQ(std::system(command.c_str()), 0);
  ::testing::internal::CaptureStderr();
  const RecordingReader reader = import("in.npz");
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("color: the times of 1 of 12 images run backward"), std::string::npos)
      << text;
  EXPECT_EQ(reader.read_camera_frame(5).color[3], 106);
  EXPECT_NEAR(reader.recording().camera_times.host_time_s[11], 0.363, 1e-6);
}

}  // namespace
}  // namespace touchtrace
