#pragma once

#include <Eigen/Geometry>

#include "calib/camera/camera.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Error model of a stereo depth sensor (Nguyen et al., 3DIMPVT 2012; Handa et al., ICRA 2014):
/// white disparity noise, disparity quantisation, lateral shift of rays, occlusion shadows, linear
/// depth error. Lengths in pixels are those of an image 640 pixels wide, whatever size it sends.
struct DepthSensor {
  double baseline_m, disparity_sigma_px;
  double disparity_step_px;  ///< 0: not quantised
  double shift_sigma_px;     ///< standard deviation of a ray's lateral shift
  double min_depth_m, max_depth_m;
  bool holes = true;  ///< no depth in occlusion shadows and at ragged edges
  /// True depth = offset + scale * measured depth.
  double scale = 1.0, offset_m = 0.0;

  explicit DepthSensor(const CameraParameters& parameters = {});
  /// Sensor without noise, quantisation, holes or error, for tests of the geometry.
  static DepthSensor exact();
};

/// True model of the RGB-D camera, which calibration estimates.
struct RgbdCamera {
  Camera color, depth;
  Eigen::Isometry3d color_from_world = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d depth_from_color = Eigen::Isometry3d::Identity();
  DepthSensor sensor;
  double depth_unit_m = 0.00025;
  double exposure_s = CameraParameters{}.exposure_s;
  /// Standard deviation of a pixel of the 640 pixels wide sensor; smaller images are averages.
  double color_noise_counts = CameraParameters{}.noise_counts;
};

inline constexpr int sensor_width_px = 640;

/// Draws the camera instance of `options.seed`, in the position that the activity needs.
RgbdCamera make_camera(const SceneOptions& options);

/// The camera's self-description: size, depth unit, factory intrinsics, gravity by its
/// accelerometer.
CameraInfo camera_info(const RgbdCamera& camera, const SceneOptions& options);

/// Truth::calibration.
nlohmann::json calibration_truth(const RgbdCamera& camera);

}  // namespace touchtrace::scene
