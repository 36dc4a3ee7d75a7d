#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "pipeline/acquire/import/bags/message_file.h"

namespace touchtrace {

/// sensor_msgs/Image or sensor_msgs/CompressedImage, not decoded yet.
struct RosImage {
  double stamp_s = 0.0;  ///< of the header: the device's clock
  std::string frame_id;
  bool is_compressed = false;
  std::string encoding;                           ///< of a compressed image: its format
  std::uint32_t height = 0, width = 0, step = 0;  ///< 0 of a compressed image
  bool is_big_endian = false;
  ByteSpan data;  ///< in the message

  bool is_depth() const;
};

bool is_image_type(const std::string& type);

// Readers of messages. They throw std::exception for an invalid message.

RosImage parse_image(ByteSpan message, const std::string& type, RosSerialization serialization);
/// Fields of a sensor_msgs/CameraInfo that describe the camera, by name.
nlohmann::json parse_camera_info(ByteSpan message, RosSerialization serialization);
/// Value of a std_msgs/Float32 message in ROS 1 serialization.
float parse_float32(ByteSpan message);

/// Pixels: CV_8UC3, blue first, or of depth CV_16UC1 counts or CV_32FC1 metres. Throws
/// std::exception for a damaged image and for an encoding that is not supported.
cv::Mat decode(const RosImage& image);

}  // namespace touchtrace
