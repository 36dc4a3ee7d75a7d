#pragma once

#include <Eigen/Geometry>

#include "calib/camera/camera.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// A stereo depth sensor (Nguyen et al., 3DIMPVT 2012; Handa et al., ICRA 2014). Its pixels are
/// those of a 640 pixels wide image, whatever size it sends.
struct DepthSensor {
  double baseline_m, disparity_sigma_px;
  double disparity_step_px;  ///< 0: not quantised
  double shift_sigma_px;     ///< of where a pixel really looks
  double nearest_m, farthest_m;
  bool holes = true;  ///< occlusion shadows and ragged edges are not measured
  /// True depth = offset + scale * measured depth; what calibration has to find.
  double scale = 1.0, offset_m = 0.0;

  explicit DepthSensor(const CameraParameters& parameters = {});
  /// No noise, no steps, no holes and no error: for tests of the geometry.
  static DepthSensor exact();
};

/// The RGBD camera as it is; what a user can only estimate.
struct RgbdCamera {
  Camera color, depth;
  Eigen::Isometry3d color_from_world = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d depth_from_color = Eigen::Isometry3d::Identity();
  DepthSensor sensor;
  double depth_unit_m = 0.00025;
  double exposure_s = CameraParameters{}.exposure_s;
  /// Of a pixel of the 640 pixels wide sensor; smaller ones are its means.
  double color_noise_counts = CameraParameters{}.noise_counts;
};

inline constexpr int sensor_width_px = 640;

/// The camera of a recording, before the person, as the activity needs it: another specimen for
/// each seed.
RgbdCamera make_camera(const SceneOptions& options);

/// What the camera says of itself, gravity by its own accelerometer (0.3 degrees off).
CameraInfo camera_info(const RgbdCamera& camera, const SceneOptions& options);

/// Truth::calibration.
nlohmann::json calibration_truth(const RgbdCamera& camera);

}  // namespace touchtrace::scene
