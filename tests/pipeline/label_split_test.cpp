#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/label/split.h"

namespace touchtrace::label {
namespace {

/// A flat square of points `half_m` to each side of `center_m`, 5 mm apart.
void add_square(Surface& surface, const Eigen::Vector3f& center_m, float half_m) {
  for (float x = -half_m; x <= half_m; x += 0.005f)
    for (float y = -half_m; y <= half_m; y += 0.005f)
      surface.push_back({center_m + Eigen::Vector3f(x, y, 0.0f), 0, 0, {}, Body::hand});
}

const Eigen::Vector3f hand_m(0.0f, 0.0f, 1.0f);

/// How many points are the object's after a hand and a square beside it, by so much.
std::ptrdiff_t object_points(const Eigen::Vector3f& beside_m, float half_m) {
  Surface surface;
  add_square(surface, hand_m, 0.05f);
  const auto hand = std::ssize(surface);
  add_square(surface, hand_m + beside_m, half_m);
  split_from_hand(surface, hand_m.cast<double>(), 0.03, 50);
  EXPECT_TRUE(std::all_of(surface.begin(), surface.begin() + hand,
                          [](const SurfacePoint& point) { return point.body == Body::hand; }));
  return std::ranges::count(surface, Body::object, &SurfacePoint::body);
}

TEST(LabelSplit, WhatHangsBesideTheHandIsTheObject) {
  EXPECT_EQ(object_points({0.0f, -0.15f, 0.0f}, 0.021f), 81);
  EXPECT_EQ(object_points({0.0f, 0.0f, -0.12f}, 0.021f), 81);
}

TEST(LabelSplit, WhatTouchesTheHandIsTheHands) {
  EXPECT_EQ(object_points({0.0f, -0.075f, 0.0f}, 0.021f), 0);
}

TEST(LabelSplit, WhatIsLargerThanTheObjectIsNotIt) {
  EXPECT_EQ(object_points({0.0f, -0.25f, 0.0f}, 0.051f), 0);
}

TEST(LabelSplit, WhatIsTooSmallForTheObjectIsAFinger) {
  EXPECT_EQ(object_points({0.0f, -0.15f, 0.0f}, 0.011f), 0);
}

TEST(LabelSplit, NothingIsSplitOfNothing) {
  Surface surface;
  split_from_hand(surface, hand_m.cast<double>(), 0.03, 50);
  EXPECT_TRUE(surface.empty());
}

}  // namespace
}  // namespace touchtrace::label
