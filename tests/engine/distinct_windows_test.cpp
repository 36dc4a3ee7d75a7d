#include "engine/train/distinct_windows.h"

#include <gtest/gtest.h>

#include <vector>

namespace touchtrace {
namespace {

constexpr TactileWindowShape pairs_of_frames{0, 2, 1, 2};

TEST(DistinctWindows, ListsOverlappingWindowsOnce) {
  const std::vector<float> stream{1, 2, 3, 4, 5, 6, 7, 8};
  const auto windows = distinct_windows(stream, pairs_of_frames, std::vector{1, 2, 2, 3, 1});
  EXPECT_EQ(windows.window_end, (std::vector{1, 2, 3}));
  EXPECT_EQ(windows.row, (std::vector{0, 1, 1, 2, 0}));
}

TEST(DistinctWindows, FindsEqualContents) {
  const std::vector<float> stream{0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
  const auto windows = distinct_windows(stream, pairs_of_frames, std::vector{1, 2, 3, 4});
  EXPECT_EQ(windows.window_end, (std::vector{1, 2, 3}));
  EXPECT_EQ(windows.row, (std::vector{0, 1, 2, 0}));
}

TEST(DistinctWindows, AcceptsEmptyInput) {
  const auto windows = distinct_windows({}, pairs_of_frames, {});
  EXPECT_TRUE(windows.window_end.empty() && windows.row.empty());
}

}  // namespace
}  // namespace touchtrace
