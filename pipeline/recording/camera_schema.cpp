#include "pipeline/recording/camera_schema.h"

#include <fmt/core.h>

#include <algorithm>

namespace touchtrace {
namespace {

constexpr double max_rotation_error = 1e-3, max_baseline_m = 10.0;

CameraAttributes attributes_of(const std::optional<Camera>& camera, double rate_hz) {
  CameraAttributes a;
  if (rate_hz > 0.0) a.rate_hz = {rate_hz};
  if (!camera) return a;
  a.intrinsics = {camera->fx, camera->fy, camera->cx, camera->cy};
  const LensInterop interop = lens_interop(camera->lens);
  a.distortion_model = interop.ros;
  a.distortion.assign(camera->distortion.data(),
                      camera->distortion.data() + interop.num_ros_coefficients);
  return a;
}

/// Simplest lens with this ROS model and number of coefficients, trailing zeros omitted.
std::optional<Lens> find_ros_lens(const std::string& model, std::size_t num_coefficients) {
  for (const Lens& lens : all_lenses())
    if (model == lens_interop(lens).ros && coefficient_names(lens).size() >= num_coefficients)
      return lens;
  return std::nullopt;
}

void set_lens(const CameraAttributes& a, const h5::Loader& group, Camera& camera) {
  std::vector<double> k = a.distortion;
  while (!k.empty() && k.back() == 0.0) k.pop_back();
  const std::string implied = k.size() > 5 ? "rational_polynomial" : "plumb_bob";
  const std::string& model = a.distortion_model.empty() ? implied : a.distortion_model;
  const auto lens = find_ros_lens(model, k.size());
  if (!lens)
    return group.faults().add(
        attribute_path(group.path(), "distortion_model"),
        fmt::format("expected plumb_bob (k1 k2 p1 p2 k3), rational_polynomial (8 coefficients) or "
                    "equidistant (4), found '{}' with {} coefficients",
                    model, k.size()));
  camera.lens = *lens;
  std::ranges::copy(k, camera.distortion.data());
}

void require_size(const std::vector<double>& values, std::size_t size, const std::string& name,
                  const h5::Loader& group) {
  group.faults().require(values.empty() || values.size() == size,
                         attribute_path(group.path(), name),
                         fmt::format("expected length {}, found {}", size, values.size()));
}

std::optional<Camera> camera_of(const CameraAttributes& a, const h5::Loader& group, int width,
                                int height) {
  require_size(a.rate_hz, 1, "rate_hz", group);
  require_size(a.intrinsics, 4, "intrinsics", group);
  if (a.intrinsics.size() != 4) return std::nullopt;
  Camera camera{width, height, a.intrinsics[0], a.intrinsics[1], a.intrinsics[2], a.intrinsics[3]};
  group.faults().require(camera.fx > 0.0 && camera.fy > 0.0,
                         attribute_path(group.path(), "intrinsics"),
                         fmt::format("expected fx, fy, cx, cy with fx, fy > 0, found {} and {}",
                                     camera.fx, camera.fy));
  set_lens(a, group, camera);
  return camera;
}

std::optional<Eigen::Isometry3d> depth_from_color(const CameraAttributes& a,
                                                  const h5::Loader& group) {
  require_size(a.depth_from_color, 16, "depth_from_color", group);
  if (a.depth_from_color.size() != 16) return std::nullopt;
  Eigen::Isometry3d pose;
  pose.matrix() =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(a.depth_from_color.data());
  const Eigen::Matrix3d rotation = pose.linear();
  const bool valid =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm() < max_rotation_error &&
      rotation.determinant() > 0.0 && pose.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
      pose.translation().norm() < max_baseline_m;
  group.faults().require(valid, attribute_path(group.path(), "depth_from_color"),
                         "expected a rotation and a translation [m] of less than 10 m as a 4x4 "
                         "matrix, found another matrix");
  return pose;
}

}  // namespace

CameraAttributes color_attributes(const CameraInfo& info) {
  CameraAttributes a = attributes_of(info.color_camera, info.rate_hz);
  if (const auto& g = info.gravity_m_per_s2) a.gravity.assign(g->data(), g->data() + 3);
  return a;
}

CameraAttributes depth_attributes(const CameraInfo& info) {
  CameraAttributes a = attributes_of(info.depth_camera, info.rate_hz);
  a.depth_unit_m = {info.depth_unit_m};
  a.registered = info.is_registered ? 1 : 0;
  if (!info.depth_from_color) return a;
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = info.depth_from_color->matrix();
  a.depth_from_color.assign(rows.data(), rows.data() + rows.size());
  return a;
}

void set_color_attributes(const CameraAttributes& a, const h5::Loader& group, CameraInfo& info) {
  info.color_camera = camera_of(a, group, info.width, info.height);
  require_size(a.gravity, 3, "gravity", group);
  if (a.gravity.size() == 3) info.gravity_m_per_s2 = Eigen::Vector3d(a.gravity.data());
}

void set_depth_attributes(const CameraAttributes& a, const h5::Loader& group, CameraInfo& info) {
  info.depth_camera = camera_of(a, group, info.depth_image_width(), info.depth_image_height());
  require_size(a.depth_unit_m, 1, "depth_unit_m", group);
  info.is_registered = a.registered != 0;
  info.depth_from_color = depth_from_color(a, group);
  group.faults().require(
      !info.is_registered ||
          (info.depth_image_width() == info.width && info.depth_image_height() == info.height),
      attribute_path(group.path(), "registered"),
      fmt::format("expected depth images of the colour images' size {} x {}, found {} x {}",
                  info.width, info.height, info.depth_image_width(), info.depth_image_height()));
}

std::array<double, 4> depth_intrinsics(const CameraInfo& camera) {
  if (!camera.depth_camera) return {};
  return {camera.depth_camera->fx, camera.depth_camera->fy, camera.depth_camera->cx,
          camera.depth_camera->cy};
}

void read_driver_values_1(const h5::Loader& group, CameraInfo& info) {
  std::vector<double> gravity, k;
  group.array("gravity", gravity, {{"xyz", 3}}, {"m s-2", ""});
  group.array("depth_intrinsics", k, {{"fx_fy_cx_cy", 4}}, {"1", ""});
  if (gravity.size() == 3 && !Eigen::Vector3d(gravity.data()).isZero())
    info.gravity_m_per_s2 = Eigen::Vector3d(gravity.data());
  if (k.size() == 4 && k[0] > 0.0)
    info.depth_camera =
        Camera{info.depth_image_width(), info.depth_image_height(), k[0], k[1], k[2], k[3]};
}

}  // namespace touchtrace
