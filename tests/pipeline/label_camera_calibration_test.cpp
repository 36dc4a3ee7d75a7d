#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/label/camera_calibration.h"
#include "tests/support/expect_error.h"

namespace touchtrace::label {
namespace {

Camera camera_of(int width, int height) {
  return {width, height, 600.0, 600.0, 0.5 * width, 0.5 * height};
}

CameraInfo registered(int width, int height) {
  CameraInfo camera;
  camera.width = width, camera.height = height;
  camera.is_registered = true;
  camera.color_camera = camera_of(width, height);
  return camera;
}

TEST(CameraCalibration, RefusesImagesOfAnotherSize) {
  RgbdCalibration given;
  given.color = camera_of(640, 480);
  EXPECT_NO_THROW(camera_calibration(given, registered(640, 480)));
  testing::expect_error(
      [&] { camera_calibration(given, registered(1280, 480)); },
      "calibration of colour images of 640 x 480 pixels, recording has 1280 x 480", {});
  given.depth = camera_of(320, 240);
  EXPECT_THROW(camera_calibration(given, registered(640, 480)), Error);
}

TEST(CameraCalibration, TakesWhatIsMissingFromTheDriver) {
  const auto registered_depth = camera_calibration(std::nullopt, registered(640, 480));
  EXPECT_FALSE(registered_depth.depth);
  EXPECT_EQ(registered_depth.color.cx, 320.0);
  auto camera = registered(640, 480);
  camera.is_registered = false;
  EXPECT_THROW(camera_calibration(std::nullopt, camera), Error);
  camera.depth_width = 320, camera.depth_height = 240;
  camera.depth_camera = camera_of(320, 240);
  camera.depth_from_color = Eigen::Translation3d(0.02, 0.0, 0.0) * Eigen::Isometry3d::Identity();
  const auto apart = camera_calibration(std::nullopt, camera);
  ASSERT_TRUE(apart.depth);
  EXPECT_EQ(apart.depth->width, 320);
  EXPECT_EQ(apart.depth_from_color.translation().x(), 0.02);
}

/// Without a covariance of its own, 0.5 % of focal length and depth scale.
TEST(CameraCalibration, HasAStatedUncertainty) {
  const auto calibration = camera_calibration(std::nullopt, registered(640, 480));
  ASSERT_EQ(calibration.parameters.size(), 5u);
  EXPECT_NEAR(std::sqrt(calibration.covariance(0, 0)), 3.0, 1e-12);
  EXPECT_NEAR(std::sqrt(calibration.covariance(4, 4)), 0.005, 1e-12);
}

}  // namespace
}  // namespace touchtrace::label
