#include "pipeline/scene/camera/camera_model.h"

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/scene/base/rotation.h"
#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {
namespace {

/// Draws a pinhole camera with the principal point near the image centre.
Camera draw_pinhole(RandomStream& random, int width, int height, const CameraParameters& p) {
  const double size = static_cast<double>(width) / sensor_width_px;
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = size * random.normal(p.focal_px, p.focal_std_px);
  camera.fy = camera.fx * random.normal(1.0, 0.001);
  camera.cx = 0.5 * (width - 1) + size * random.normal(0.0, p.centre_std_px);
  camera.cy = 0.5 * (height - 1) + size * random.normal(0.0, p.centre_std_px);
  return camera;
}

Eigen::Quaterniond small_rotation(RandomStream& random, double sigma_rad) {
  const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
  const double angle = turn.norm() * sigma_rad;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn.normalized()));
}

/// Intrinsics that the depth camera's driver reports, with the errors of a factory calibration.
Camera factory_camera(RandomStream random, const Camera& camera) {
  constexpr double error = 1e-3;
  Camera factory{camera.width, camera.height};
  factory.fx = camera.fx * random.normal(1.0, error);
  factory.fy = camera.fy * random.normal(1.0, error);
  factory.cx = camera.cx + camera.width * random.normal(0.0, error);
  factory.cy = camera.cy + camera.width * random.normal(0.0, error);
  return factory;
}

/// Pose camera_from_world of a camera that looks along +y of the world, `pitch_rad` downwards.
/// Camera axes: x right, y down, z forward.
Eigen::Isometry3d pose_towards_person(const Eigen::Vector3d& position_m, double pitch_rad) {
  Eigen::Matrix3d level;
  level << 1, 0, 0,  //
      0, 0, -1,      //
      0, 1, 0;
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  camera_from_world.linear() = Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()) * level;
  camera_from_world.translation() = -camera_from_world.linear() * position_m;
  return camera_from_world;
}

Eigen::Isometry3d draw_depth_pose(RandomStream& random, double distance_m) {
  Eigen::Isometry3d depth_from_color(small_rotation(random, 0.3 * radians_per_degree));
  depth_from_color.translation() << distance_m + random.normal(0.0, 3e-4), random.normal(0.0, 3e-4),
      random.normal(0.0, 3e-4);
  return depth_from_color;
}

nlohmann::json matrix_json(const Eigen::Matrix4d& m) {
  auto rows = nlohmann::json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2), m(i, 3)});
  return rows;
}

nlohmann::json camera_json(const Camera& camera) {
  const auto& k = camera.distortion;
  return {{"width", camera.width},
          {"height", camera.height},
          {"intrinsics_px", {camera.fx, camera.fy, camera.cx, camera.cy}},
          {"distortion_k1_k2_p1_p2_k3", {k[0], k[1], k[2], k[3], k[4]}}};
}

}  // namespace

DepthSensor::DepthSensor(const CameraParameters& p)
    : baseline_m(p.baseline_m),
      disparity_sigma_px(p.disparity_sigma_px),
      disparity_step_px(p.disparity_step_px),
      shift_sigma_px(p.shift_sigma_px),
      min_depth_m(p.min_depth_m),
      max_depth_m(p.max_depth_m) {}

DepthSensor DepthSensor::exact() {
  DepthSensor sensor;
  sensor.disparity_sigma_px = sensor.disparity_step_px = sensor.shift_sigma_px = 0.0;
  sensor.holes = false;
  return sensor;
}

RgbdCamera make_camera(const SceneOptions& options) {
  const ActivityRow& from = find_activity(options.activity);
  const CameraParameters& p = options.parameters.camera;
  RandomStream random(options.seed, "camera specimen");
  RgbdCamera camera;
  camera.color = draw_pinhole(random, options.image_width, options.image_height, p);
  camera.color.lens = Radtan4{};
  camera.color.distortion.head<4>() << random.normal(p.k1, p.radial_std),
      random.normal(p.k2, p.radial_std), random.normal(0.0, p.tangential_std),
      random.normal(0.0, p.tangential_std);
  camera.depth = draw_pinhole(random, options.image_width, options.image_height, p);
  camera.depth_from_color = draw_depth_pose(random, p.color_depth_distance_m);
  camera.color_from_world = pose_towards_person(
      {random.normal(-0.08, p.place_std_m), -from.camera_distance_m,
       random.normal(p.height_m, p.place_std_m)},
      random.normal(from.camera_pitch_deg, p.pitch_std_deg) * radians_per_degree);
  camera.sensor = DepthSensor(p);
  camera.sensor.scale = random.normal(1.0, p.scale_std);
  camera.sensor.offset_m = random.normal(0.0, p.offset_std_m);
  camera.exposure_s = p.exposure_s, camera.color_noise_counts = p.noise_counts;
  return camera;
}

CameraInfo camera_info(const RgbdCamera& camera, const SceneOptions& options) {
  RandomStream random(options.seed, "camera accelerometer");
  const Eigen::Vector3d down(0.0, 0.0, -gravity_m_per_s2);
  const double error_rad =
      options.parameters.camera.gravity_std_deg * radians_per_degree / std::sqrt(3.0);
  const Eigen::Quaterniond error = small_rotation(random, error_rad);
  const Eigen::Vector3d gravity = error * (camera.color_from_world.linear() * down);
  CameraInfo info;
  info.width = camera.color.width, info.height = camera.color.height;
  info.depth_unit_m = camera.depth_unit_m;
  info.depth_camera =
      factory_camera(RandomStream(options.seed, "factory calibration"), camera.depth);
  info.gravity_m_per_s2 = gravity;
  return info;
}

nlohmann::json calibration_truth(const RgbdCamera& camera) {
  return {{"color", camera_json(camera.color)},
          {"depth", camera_json(camera.depth)},
          {"depth_from_color", matrix_json(camera.depth_from_color.matrix())},
          {"color_from_world", matrix_json(camera.color_from_world.matrix())},
          {"depth_scale", camera.sensor.scale},
          {"depth_offset_m", camera.sensor.offset_m},
          {"disparity_sigma_px", camera.sensor.disparity_sigma_px},
          {"disparity_step_px", camera.sensor.disparity_step_px}};
}

}  // namespace touchtrace::scene
