#include "pipeline/label/camera_calibration.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace::label {
namespace {

constexpr const char* how_to_calibrate =
    "give --calibration (touchtrace calibrate, or a camera_info file), or import the recording "
    "with --camera-info";

RgbdCalibration driver_calibration(const CameraInfo& camera) {
  const auto& color = camera.color_camera ? camera.color_camera : camera.depth_camera;
  if (!color || (!camera.is_registered && !camera.color_camera))
    throw data_error("the recording does not have the colour camera's intrinsics",
                     how_to_calibrate);
  RgbdCalibration calibration;
  calibration.color = *color;
  return calibration;
}

/// Depth images on the colour camera's pixels need no depth camera.
void add_depth_camera(RgbdCalibration& calibration, const CameraInfo& camera) {
  if (calibration.depth || camera.is_registered) return;
  if (!camera.depth_camera || !camera.depth_from_color)
    throw data_error(
        "depth images are not registered to colour, and the depth camera's intrinsics or pose are "
        "unknown",
        how_to_calibrate);
  calibration.depth = camera.depth_camera;
  calibration.depth_from_color = *camera.depth_from_color;
}

void require_size(const Camera& calibrated, int width, int height, const char* name) {
  if (calibrated.width == width && calibrated.height == height) return;
  throw data_error(fmt::format("calibration of {} images of {} x {} pixels, recording has {} x {}",
                               name, calibrated.width, calibrated.height, width, height),
                   "use the calibration of this camera at this image size");
}

void add_default_covariance(RgbdCalibration& calibration) {
  const Camera& camera = calibration.depth ? *calibration.depth : calibration.color;
  const std::string name = calibration.depth ? "depth." : "color.";
  const double centre_px = default_centre_sigma * camera.width;
  calibration.parameters = {name + "fx", name + "fy", name + "cx", name + "cy", "depth.scale"};
  calibration.covariance =
      Eigen::Matrix<double, 5, 1>(default_focal_sigma * camera.fx, default_focal_sigma * camera.fy,
                                  centre_px, centre_px, default_focal_sigma)
          .cwiseAbs2()
          .asDiagonal();
}

}  // namespace

RgbdCalibration camera_calibration(const std::optional<RgbdCalibration>& given,
                                   const CameraInfo& camera) {
  RgbdCalibration calibration = given ? *given : driver_calibration(camera);
  add_depth_camera(calibration, camera);
  require_size(calibration.color, camera.width, camera.height, "colour");
  const Camera& depth = calibration.depth ? *calibration.depth : calibration.color;
  require_size(depth, camera.depth_image_width(), camera.depth_image_height(), "depth");
  if (calibration.covariance.size() == 0) add_default_covariance(calibration);
  return calibration;
}

}  // namespace touchtrace::label
