#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Attributes of /color or /depth. Empty vectors and texts are not in the file.
struct CameraAttributes {
  std::vector<double> rate_hz;       ///< [1], nominal
  std::vector<double> intrinsics;    ///< [4]: fx, fy, cx, cy [px]
  std::string distortion_model;      ///< as in a ROS CameraInfo
  std::vector<double> distortion;    ///< coefficients, in the order of that model
  std::vector<double> gravity;       ///< [3], only of /color
  std::vector<double> depth_unit_m;  ///< [1], only of /depth, like the following
  int registered = 0;
  std::vector<double> depth_from_color;  ///< [4, 4], row-major
};

CameraAttributes color_attributes(const CameraInfo& info);
CameraAttributes depth_attributes(const CameraInfo& info);
/// Set the members of `info` that the attributes describe. Faults are those of `group`.
void set_color_attributes(const CameraAttributes& attributes, const h5::Loader& group,
                          CameraInfo& info);
void set_depth_attributes(const CameraAttributes& attributes, const h5::Loader& group,
                          CameraInfo& info);

/// Intrinsics fx, fy, cx, cy of the depth camera; zeros if unknown.
std::array<double, 4> depth_intrinsics(const CameraInfo& camera);
/// Reads gravity and intrinsics of the depth camera from the group /camera of schema 1.
void read_driver_values_1(const h5::Loader& group, CameraInfo& info);

template <class Archive, class Attributes>
void serialize_camera(Archive& group, Attributes& a) {
  group.optional_attribute("rate_hz", a.rate_hz);
  group.optional_attribute("intrinsics", a.intrinsics);
  group.optional_attribute("distortion_model", a.distortion_model);
  group.optional_attribute("distortion", a.distortion);
}

template <class Archive, class Attributes>
void serialize_color(Archive& group, Attributes& a) {
  serialize_camera(group, a);
  group.optional_attribute("gravity", a.gravity);
}

template <class Archive, class Attributes>
void serialize_depth(Archive& group, Attributes& a) {
  serialize_camera(group, a);
  group.optional_attribute("depth_unit_m", a.depth_unit_m);
  group.optional_attribute("registered", a.registered);
  group.optional_attribute("depth_from_color", a.depth_from_color);
}

/// Returns the frame axis.
template <class Archive, class Times>
h5::Axis serialize_camera_times(Archive& group, Times& times) {
  const h5::Axis frame = group.axis("host_time_s", times.host_time_s, {"s", "arrival, host clock"});
  group.optional_array("device_time_s", times.device_time_s, {frame}, {"s", "camera's clock"});
  group.optional_array("sequence", times.sequence, {frame}, {"1", "frame counter of the camera"});
  return frame;
}

}  // namespace touchtrace
