#include <gtest/gtest.h>

#include "pipeline/label/track/observation.h"
#include "pipeline/label/track/target.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::label {
namespace {

using Eigen::Vector3d;

constexpr double disc_m = 0.02, frame_s = 0.05;
const Vector3d held_m(0.0, 0.0, 1.0), in_flight_m(0.10, 0.0, 1.0);

Segmenter segmenter() {
  return Segmenter(staged::calibration(), staged::camera_recording({}, {}).camera);
}

/// Points of a disc of the object's colour, of which the fraction `part` is visible.
Surface disc_at(const Vector3d& centre_m, double part, double radius_m = disc_m) {
  Surface surface;
  const auto pixels = segmenter().disc_pixels(radius_m, centre_m.z());
  for (int i = 0; i < part * pixels; ++i) {
    const double along = std::sqrt((i + 0.5) / pixels) * radius_m, angle = 2.4 * i;
    const Vector3d position = centre_m + along * Vector3d(std::cos(angle), std::sin(angle), 0.0);
    surface.push_back({position.cast<float>(), 0, 0, {}, Body::object});
  }
  return surface;
}

/// Target that was held until the last frame.
Target held_target() {
  Target target(Body::object, disc_m, 1.6 * disc_m, 6, find_tracker("component"));
  target.start(held_m, 0.002, {}, {});
  for (int i = 0; i < 5; ++i) {
    target.predict(frame_s, false, Vector3d(0.0, 9.81, 0.0));
    target.measure(held_m, 0.002);
  }
  target.predict(frame_s, false, Vector3d(0.0, 9.81, 0.0));
  return target;
}

/// Whether a held target is found in the next frame's surface.
bool is_found(const Surface& surface) {
  return held_target().find(surface, {}, std::nullopt, segmenter(), held_m).has_value();
}

bool is_found(const Vector3d& centre_m, double part) { return is_found(disc_at(centre_m, part)); }

TEST(Target, FindsAnyPartNearItsPrediction) {
  EXPECT_TRUE(is_found(held_m, 1.0));
  EXPECT_TRUE(is_found(held_m + Vector3d(0.03, 0.0, 0.0), 0.1));
}

TEST(Target, FindsOnlyALargePartFarFromItsPrediction) {
  EXPECT_TRUE(is_found(in_flight_m, 0.9));
  EXPECT_FALSE(is_found(in_flight_m, 0.1));
}

TEST(Target, RejectsALargeSurfaceOfItsColor) {
  EXPECT_FALSE(is_found(disc_at(held_m, 1.0, 5.0 * disc_m)));
}

TEST(Target, PrefersPatchesNearItsLastPositionWhenLost) {
  auto target = held_target();
  while (!target.is_lost()) target.find({}, {}, std::nullopt, segmenter(), std::nullopt);
  const Vector3d near_m = held_m + Vector3d(0.2, 0.0, 0.0);
  auto surface = disc_at(near_m, 0.6);
  const auto farther = disc_at(held_m - Vector3d(0.3, 0.3, 0.5), 1.0);
  surface.insert(surface.end(), farther.begin(), farther.end());
  const auto found = target.find(surface, {}, std::nullopt, segmenter(), std::nullopt);
  ASSERT_TRUE(found);
  EXPECT_LT((found->centroid_m - near_m).norm(), disc_m);
}

/// A hand at 1 m fills 707 pixels of this camera, its fringe 42, of which 30 points are enough.
TEST(Target, TakesNoFringeForTheHand) {
  constexpr double hand_disc_m = 0.05;
  for (const auto& [part, is_expected] : {std::pair{0.06, false}, {0.1, true}}) {
    Target target(Body::hand, hand_disc_m, hand_patch_radius_m, 30, find_tracker("component"));
    target.start(held_m, 0.002, {}, {});
    target.predict(frame_s, false, Vector3d(0.0, 9.81, 0.0));
    auto surface = disc_at(held_m, part, hand_disc_m);
    for (auto& point : surface) point.body = Body::hand;
    EXPECT_GT(surface.size(), 30u);
    EXPECT_EQ(target.find(surface, {}, std::nullopt, segmenter(), std::nullopt).has_value(),
              is_expected)
        << part;
  }
}

TEST(Target, FindsNothingInAnEmptySurface) { EXPECT_FALSE(is_found(held_m, 0.0)); }

/// A fist, or a forearm that goes on beyond it.
TEST(Hand, IsOnAnArmThatGoesOnBeyondIt) {
  Surface surface;
  for (int along_mm = -40; along_mm <= 40; along_mm += 5)
    for (int across_mm = -40; across_mm <= 40; across_mm += 5)
      surface.push_back(
          {{0.001f * float(along_mm), 0.001f * float(across_mm), 1.0f}, 0, 0, {}, Body::hand});
  const auto is_arm = [&] {
    const auto hand = find_patch(surface, Body::hand, held_m, hand_patch_radius_m, 30);
    return hand && is_on_arm(*hand, surface);
  };
  EXPECT_FALSE(is_arm());
  for (int along_mm = 45; along_mm <= 250; along_mm += 5)
    for (int across_mm = -30; across_mm <= 30; across_mm += 5)
      surface.push_back(
          {{0.001f * float(along_mm), 0.001f * float(across_mm), 1.0f}, 0, 0, {}, Body::hand});
  EXPECT_TRUE(is_arm());
  for (auto& point : surface)
    if (point.position_m.x() > 0.1f) point.body = Body::rest;
  EXPECT_FALSE(is_arm()) << "in a sleeve";
}

}  // namespace
}  // namespace touchtrace::label
