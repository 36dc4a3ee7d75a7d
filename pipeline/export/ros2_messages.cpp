#include "pipeline/export/ros2_messages.h"

#include "pipeline/export/cdr_writer.h"

namespace touchtrace {
namespace {

// Definitions of ROS 2 (common_interfaces, rcl_interfaces), without comments.
constexpr const char *time_text = "int32 sec\nuint32 nanosec\n",
                     *header_text = "builtin_interfaces/Time stamp\nstring frame_id\n",
                     *vector3_text = "float64 x\nfloat64 y\nfloat64 z\n",
                     *quaternion_text = "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";

/// Appends the definition of a type that the message contains.
std::string part(const char* name, const char* text) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + text;
}

std::string with_header(const std::string& text) {
  return text + part("std_msgs/Header", header_text) + part("builtin_interfaces/Time", time_text);
}

CdrWriter start_message(const RosHeader& header) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  CdrWriter cdr;
  cdr.add(static_cast<std::int32_t>(header.stamp_ns / ns_per_s));
  cdr.add(static_cast<std::uint32_t>(header.stamp_ns % ns_per_s));
  cdr.add(header.frame_id);
  return cdr;
}

/// Block of a 6 x 6 covariance that begins at row and column `at`, as the upper left block of
/// another one, whose lower right block is that of unknown rotations.
std::array<double, 36> ros_covariance(const RosBodyState& state, std::size_t at) {
  std::array<double, 36> covariance{};
  if (!state.covariance) return covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      covariance[6 * i + j] = (*state.covariance)[6 * (at + i) + at + j];
    covariance[7 * (3 + i)] = unknown_variance;
  }
  return covariance;
}

}  // namespace

const RosType& point_stamped_type() {
  static const RosType type{"geometry_msgs/msg/PointStamped",
                            with_header("std_msgs/Header header\ngeometry_msgs/Point point\n" +
                                        part("geometry_msgs/Point", vector3_text))};
  return type;
}

const RosType& odometry_type() {
  static const RosType type{
      "nav_msgs/msg/Odometry",
      with_header(
          "std_msgs/Header header\nstring child_frame_id\n"
          "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n" +
          part("geometry_msgs/PoseWithCovariance",
               "geometry_msgs/Pose pose\nfloat64[36] covariance\n") +
          part("geometry_msgs/Pose",
               "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n") +
          part("geometry_msgs/Point", vector3_text) +
          part("geometry_msgs/Quaternion", quaternion_text) +
          part("geometry_msgs/TwistWithCovariance",
               "geometry_msgs/Twist twist\nfloat64[36] covariance\n") +
          part("geometry_msgs/Twist",
               "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n") +
          part("geometry_msgs/Vector3", vector3_text))};
  return type;
}

const RosType& image_type() {
  static const RosType type{
      "sensor_msgs/msg/Image",
      with_header("std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
                  "uint8 is_bigendian\nuint32 step\nuint8[] data\n")};
  return type;
}

const RosType& camera_info_type() {
  static const RosType type{
      "sensor_msgs/msg/CameraInfo",
      with_header("std_msgs/Header header\nuint32 height\nuint32 width\n"
                  "string distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n"
                  "float64[12] p\nuint32 binning_x\nuint32 binning_y\n"
                  "sensor_msgs/RegionOfInterest roi\n" +
                  part("sensor_msgs/RegionOfInterest",
                       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
                       "bool do_rectify\n"))};
  return type;
}

std::string point_stamped(const RosHeader& header, const std::array<double, 3>& point_m) {
  CdrWriter cdr = start_message(header);
  cdr.add_array(point_m);
  return cdr.bytes();
}

std::string odometry(const RosHeader& header, const std::string& body, const RosBodyState& state) {
  CdrWriter cdr = start_message(header);
  cdr.add(body);
  cdr.add_array(state.position_m);
  cdr.add_array(std::array{0.0, 0.0, 0.0, 1.0});
  cdr.add_array(ros_covariance(state, 0));
  cdr.add_array(state.velocity_m_per_s);
  cdr.add_array(std::array{0.0, 0.0, 0.0});
  cdr.add_array(ros_covariance(state, 3));
  return cdr.bytes();
}

std::string image(const RosHeader& header, std::uint32_t width, std::uint32_t height,
                  const std::string& encoding, std::span<const std::uint8_t> data) {
  CdrWriter cdr = start_message(header);
  cdr.add(height), cdr.add(width);
  cdr.add(encoding);
  cdr.add(std::uint8_t{0});  // the low byte comes first
  cdr.add(static_cast<std::uint32_t>(data.size() / height));
  cdr.add_byte_sequence(data);
  return cdr.bytes();
}

std::string camera_info(const RosHeader& header, const Camera& c) {
  const LensInterop interop = lens_interop(c.lens);
  CdrWriter cdr = start_message(header);
  cdr.add(static_cast<std::uint32_t>(c.height)), cdr.add(static_cast<std::uint32_t>(c.width));
  cdr.add(std::string(interop.ros));
  cdr.add_sequence({c.distortion.data(), static_cast<std::size_t>(interop.num_ros_coefficients)});
  cdr.add_array(std::array<double, 9>{c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1});
  cdr.add_array(std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  cdr.add_array(std::array<double, 12>{c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0});
  for (int i = 0; i < 6; ++i) cdr.add(std::uint32_t{0});  // binning and region: the whole image
  cdr.add(std::uint8_t{0});
  return cdr.bytes();
}

}  // namespace touchtrace
