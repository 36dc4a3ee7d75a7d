#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/observe/background.h"
#include "pipeline/label/observe/depth_color_observer.h"

namespace touchtrace::label {
namespace {

constexpr int width = 160, height = 120;
constexpr double focal_px = 150.0, unit_m = 0.001;
constexpr std::uint16_t near_mm = 1000, wall_mm = 2000;
constexpr PixelBox hand_box{20, 40, 30, 30}, object_box{90, 40, 30, 30};

std::vector<std::uint16_t> wall(std::uint16_t distance_mm = wall_mm) {
  return std::vector<std::uint16_t>(static_cast<std::size_t>(width * height), distance_mm);
}

/// A red hand and a yellow object in front of a wall of the object's colour.
RgbdFrame frame(std::uint16_t distance_mm = wall_mm) {
  RgbdFrame frame;
  frame.depth = wall(distance_mm);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const bool hand =
                     contains(hand_box,
                              {{}, static_cast<std::int16_t>(u), static_cast<std::int16_t>(v), {}}),
                 object =
                     contains(object_box,
                              {{}, static_cast<std::int16_t>(u), static_cast<std::int16_t>(v), {}});
      if (hand || object) frame.depth[static_cast<std::size_t>(v * width + u)] = near_mm;
      for (const int value : {hand ? 180 : 220, hand ? 30 : 200, hand ? 30 : 20})
        frame.color.push_back(static_cast<std::uint8_t>(value));
    }
  return frame;
}

/// Without a background.
std::shared_ptr<Segmenter> segmenter_of_camera() {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = focal_px, camera.cx = 79.5, camera.cy = 59.5;
  RgbdCalibration calibration;
  calibration.color = calibration.depth.emplace(camera);
  CameraInfo info;
  info.width = width, info.height = height, info.depth_unit_m = unit_m;
  return std::make_shared<Segmenter>(calibration, info);
}

SceneModel model(std::uint16_t distance_mm = wall_mm) {
  const auto segmenter = segmenter_of_camera();
  segmenter->set_background(wall(distance_mm), std::nullopt);
  ColorClasses colors;
  colors.learn(segmenter->foreground_surface(frame(distance_mm)), hand_box, object_box, false);
  colors.build_table();
  const auto observer = std::make_shared<DepthColorObserver>(segmenter);
  observer->set_colors("ball", std::move(colors), std::nullopt);
  return {segmenter, observer, 0.002};
}

/// The wall is at 2 m, where noise of 1 mm at 1 m is 4 mm: six standard deviations are 24 mm.
TEST(Segmenter, ForegroundBeginsSixStandardDeviationsBeforeTheBackground) {
  const auto has_foreground = [](std::optional<double> noise_at_1m, int before_mm) {
    const auto segmenter = segmenter_of_camera();
    segmenter->set_background(wall(), noise_at_1m);
    auto seen = frame();
    for (auto& depth : seen.depth)
      if (depth == near_mm) depth = static_cast<std::uint16_t>(wall_mm - before_mm);
    return !segmenter->foreground_surface(seen).empty();
  };
  EXPECT_TRUE(has_foreground(0.001, 30));
  EXPECT_FALSE(has_foreground(0.001, 22));
  EXPECT_TRUE(has_foreground(0.0001, 22)) << "at least 20 mm";
  EXPECT_FALSE(has_foreground(0.0001, 18));
  // 4 % of the distance are enough whatever the noise
  EXPECT_FALSE(has_foreground(std::nullopt, 78));
  EXPECT_TRUE(has_foreground(std::nullopt, 90));
  EXPECT_TRUE(has_foreground(0.01, 90));
}

/// At 1.1 m the wall is within reach of the object.
TEST(ViewObject, ExcludesAWallOfTheObjectsColor) {
  for (const std::uint16_t distance_mm : {wall_mm, std::uint16_t{1100}}) {
    const SceneModel scene = model(distance_mm);
    const auto seen = frame(distance_mm);
    const auto patch = find_patch(scene.observer->observe(seen, "ball"), Body::object,
                                  {0.17, -0.03, 1.0}, 0.15, 12);
    ASSERT_TRUE(patch);
    for (const bool whole : {false, true}) {
      const auto view = scene.view_object(seen, "ball", *patch, 0.25, whole);
      EXPECT_GT(view.surface_points.size(), 500u);
      EXPECT_GT(view.free_space_endpoints.size(), 500u);
      for (const auto& point : view.surface_points) EXPECT_NEAR(point.z(), 1.0, 1e-3);
    }
  }
}

/// Free-space rays end at points of neither colour, but 15 mm behind points of the hand.
TEST(ViewObject, DoesNotExtendRaysToPointsOfNeitherColor) {
  const SceneModel scene = model();
  auto rimmed = frame();
  for (int v = object_box.y; v < object_box.y + object_box.height; ++v)
    for (std::size_t channel = 0; channel < 3; ++channel)
      rimmed.color[3 * static_cast<std::size_t>(v * width + object_box.x) + channel] = 90;
  const auto patch = find_patch(scene.observer->observe(rimmed, "ball"), Body::object,
                                {0.17, -0.03, 1.0}, 0.15, 12);
  ASSERT_TRUE(patch);
  int rim = 0, hand = 0;
  for (const auto& point :
       scene.view_object(rimmed, "ball", *patch, 0.4, false).free_space_endpoints) {
    rim += std::abs(point.z() - 1.0) < 1e-3;
    hand += point.z() > 1.01 && point.z() < 1.02;
  }
  EXPECT_GE(rim, object_box.height - 2);
  EXPECT_GT(hand, 0);
}

TEST(ViewObject, NoiseRatioGrowsWithDepthSquared) {
  const SceneModel scene = model();
  Patch near, far;
  near.centroid_m = {0.0, 0.0, 0.5}, far.centroid_m = {0.0, 0.0, 2.0};
  EXPECT_EQ(scene.view_object(frame(), "ball", near, 0.1, false).noise_ratio, 1.0);
  EXPECT_NEAR(scene.view_object(frame(), "ball", far, 0.1, false).noise_ratio,
              0.002 * 4.0 / reference_depth_sigma_m, 1e-9);
}

TEST(ViewObject, UnknownDepthNoiseIsTakenForLarge) {
  SceneModel scene = model();
  scene.depth_noise_at_1m = std::nullopt;
  Patch patch;
  patch.centroid_m = {0.0, 0.0, 0.5};
  EXPECT_GT(scene.view_object(frame(), "ball", patch, 0.1, false).noise_ratio, 2.0);
  scene.depth_noise_at_1m = 0.0;  // as of a simulator
  EXPECT_EQ(scene.view_object(frame(), "ball", patch, 0.1, false).noise_ratio, 1.0);
}

/// Walls at 1 and 3 m; 5 % of the pixels show something that moves.
TEST(DepthNoise, IgnoresMovingPixels) {
  constexpr double noise_at_1m = 0.002;
  RandomStream random(1, "still scene");
  std::vector<std::vector<std::uint16_t>> depths(12, wall());
  for (std::size_t i = 0; i < depths.size(); ++i)
    for (std::size_t pixel = 0; pixel < depths[i].size(); ++pixel) {
      const double z = pixel % 2 ? 1.0 : 3.0, mean = pixel % 20 ? z : 0.5 + 0.1 * double(i);
      depths[i][pixel] = static_cast<std::uint16_t>(
          std::lround((mean + noise_at_1m * z * z * random.normal()) / unit_m));
    }
  EXPECT_NEAR(depth_noise_at_1m(depths, unit_m).value(), noise_at_1m, 0.1 * noise_at_1m);
  depths.resize(2);
  EXPECT_FALSE(depth_noise_at_1m(depths, unit_m));
  EXPECT_FALSE(depth_noise_at_1m({}, unit_m));
}

/// A body that moves fills the image, but for a part of it.
std::optional<double> noise_with_background_in(double part) {
  RandomStream random(2, "moving body");
  std::vector<std::vector<std::uint16_t>> depths(12, wall());
  for (std::size_t i = 0; i < depths.size(); ++i)
    for (std::size_t pixel = 0; pixel < depths[i].size(); ++pixel) {
      const bool is_background = double(pixel % 100) < 100.0 * part;
      const double z = is_background ? 1.0 : 0.4 + 0.02 * double(i);
      depths[i][pixel] =
          static_cast<std::uint16_t>(std::lround((z + 0.002 * random.normal()) / unit_m));
    }
  return depth_noise_at_1m(depths, unit_m);
}

TEST(DepthNoise, IsUnknownWhereAllMoves) {
  EXPECT_NEAR(noise_with_background_in(0.2).value(), 0.002, 0.0004);
  EXPECT_FALSE(noise_with_background_in(0.0));
}

}  // namespace
}  // namespace touchtrace::label
