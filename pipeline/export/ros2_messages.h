#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "calib/camera/camera.h"

namespace touchtrace {

/// Type of ROS 2 messages, with the definitions of all types that it contains (encoding "ros2msg"
/// of MCAP).
struct RosType {
  const char* name;
  std::string definition;
};

const RosType& point_stamped_type();
const RosType& odometry_type();
const RosType& image_type();
const RosType& camera_info_type();

/// std_msgs/Header.
struct RosHeader {
  std::int64_t stamp_ns = 0;  ///< Unix time
  std::string frame_id;
};

/// Position and velocity in the header's frame; the body has no orientation.
struct RosBodyState {
  std::array<double, 3> position_m, velocity_m_per_s;
  /// [6, 6] of (position, velocity), row-major; nullopt: unknown.
  std::optional<std::span<const double, 36>> covariance;
};

// Messages in CDR:
std::string point_stamped(const RosHeader& header, const std::array<double, 3>& point_m);
/// The pose has the identity as orientation, whose variance is `unknown_variance`. A nav_msgs
/// Odometry has no covariance between position and velocity.
std::string odometry(const RosHeader& header, const std::string& body, const RosBodyState& state);
/// `encoding`: rgb8, 16UC1 or 32FC1. `data`: rows one after the other.
std::string image(const RosHeader& header, std::uint32_t width, std::uint32_t height,
                  const std::string& encoding, std::span<const std::uint8_t> data);
std::string camera_info(const RosHeader& header, const Camera& camera);

/// Variance of a rotation [rad^2] or angular velocity [rad^2/s^2] that is not measured.
inline constexpr double unknown_variance = 1e6;

}  // namespace touchtrace
