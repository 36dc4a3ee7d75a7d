#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/label/observe/split.h"

namespace touchtrace::label {
namespace {

/// Adds a flat square grid of points 5 mm apart, `half_m` to each side of `centre_m`.
void add_square(Surface& surface, const Eigen::Vector3f& centre_m, float half_m,
                Body body = Body::hand) {
  for (float x = -half_m; x <= half_m; x += 0.005f)
    for (float y = -half_m; y <= half_m; y += 0.005f)
      surface.push_back({centre_m + Eigen::Vector3f(x, y, 0.0f), 0, 0, {}, body});
}

const Eigen::Vector3f hand_m(0.0f, 0.0f, 1.0f);

/// Number of points classified as object, for a hand and a square at an offset from it.
std::ptrdiff_t object_points(const Eigen::Vector3f& offset_m, float half_m) {
  Surface surface;
  add_square(surface, hand_m, 0.05f);
  const auto hand = std::ssize(surface);
  add_square(surface, hand_m + offset_m, half_m);
  split_from_hand(surface, hand_m.cast<double>(), 0.03, 50);
  EXPECT_TRUE(std::all_of(surface.begin(), surface.begin() + hand,
                          [](const SurfacePoint& point) { return point.body == Body::hand; }));
  return std::ranges::count(surface, Body::object, &SurfacePoint::body);
}

TEST(SplitFromHand, AComponentApartFromTheHandIsTheObject) {
  EXPECT_EQ(object_points({0.0f, -0.15f, 0.0f}, 0.021f), 81);
  EXPECT_EQ(object_points({0.0f, 0.0f, -0.12f}, 0.021f), 81);
}

TEST(SplitFromHand, PointsThatTouchTheHandStayTheHands) {
  EXPECT_EQ(object_points({0.0f, -0.075f, 0.0f}, 0.021f), 0);
}

TEST(SplitFromHand, RejectsComponentsLargerThanTheObject) {
  EXPECT_EQ(object_points({0.0f, -0.25f, 0.0f}, 0.051f), 0);
}

TEST(SplitFromHand, RejectsComponentsOfTooFewPoints) {
  EXPECT_EQ(object_points({0.0f, -0.15f, 0.0f}, 0.011f), 0);
}

TEST(SplitFromHand, AcceptsAnEmptySurface) {
  Surface surface;
  split_from_hand(surface, hand_m.cast<double>(), 0.03, 50);
  EXPECT_TRUE(surface.empty());
}

TEST(RemoveLargeComponents, KeepsWhatMayBeTheObject) {
  Surface surface;
  add_square(surface, hand_m, 0.03f, Body::object);
  const auto object = std::ssize(surface);
  add_square(surface, hand_m + Eigen::Vector3f(0.3f, 0.0f, 0.0f), 0.15f, Body::object);
  remove_large_components(surface, 0.04);
  EXPECT_TRUE(std::all_of(surface.begin(), surface.begin() + object,
                          [](const SurfacePoint& point) { return point.body == Body::object; }));
  EXPECT_EQ(std::ranges::count(surface, Body::object, &SurfacePoint::body), object);
}

}  // namespace
}  // namespace touchtrace::label
