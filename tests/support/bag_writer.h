#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace touchtrace::testing {

template <class T>
std::string bytes_of_number(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

inline std::string sized(const std::string& bytes) {
  return bytes_of_number(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

/// Bag of ROS 1 with one chunk.
class BagWriter {
 public:
  /// Returns the connection's number.
  std::uint32_t connect(const std::string& topic, const std::string& type) {
    const std::uint32_t number = connections_++;
    chunk_ += record({{"op", "\x07"}, {"conn", bytes_of_number(number)}, {"topic", topic}},
                     fields({{"topic", topic}, {"type", type}, {"md5sum", "*"}}));
    return number;
  }
  void add(std::uint32_t connection, std::uint32_t time_s, std::uint32_t time_ns,
           const std::string& message) {
    chunk_ += record({{"op", "\x02"},
                      {"conn", bytes_of_number(connection)},
                      {"time", bytes_of_number(time_s) + bytes_of_number(time_ns)}},
                     message);
  }
  /// Bytes of the chunk, and of the bag with the chunk stored as `stored`.
  const std::string& chunk() const { return chunk_; }
  std::string bag(const std::string& compression, const std::string& stored) const {
    return "#ROSBAG V2.0\n" + record({{"op", "\x03"}}, std::string(16, ' ')) +
           record({{"op", "\x05"},
                   {"compression", compression},
                   {"size", bytes_of_number(static_cast<std::uint32_t>(chunk_.size()))}},
                  stored);
  }
  std::string bag() const { return bag("none", chunk_); }

 private:
  using Fields = std::vector<std::pair<std::string, std::string>>;

  static std::string fields(const Fields& list) {
    std::string bytes;
    for (const auto& [name, value] : list) bytes += sized(name + "=" + value);
    return bytes;
  }
  static std::string record(const Fields& header, const std::string& data) {
    return sized(fields(header)) + sized(data);
  }

  std::string chunk_;
  std::uint32_t connections_ = 0;
};

/// std_msgs/Header.
inline std::string ros_header(double stamp_s, const std::string& frame) {
  const auto seconds = static_cast<std::uint32_t>(stamp_s);
  return bytes_of_number(0u) + bytes_of_number(seconds) +
         bytes_of_number(static_cast<std::uint32_t>(1e9 * (stamp_s - seconds) + 0.5)) +
         sized(frame);
}

/// sensor_msgs/Image.
inline std::string ros_image(double stamp_s, const std::string& frame, const std::string& encoding,
                             std::uint32_t width, std::uint32_t height, const std::string& data) {
  return ros_header(stamp_s, frame) + bytes_of_number(height) + bytes_of_number(width) +
         sized(encoding) + '\0' +
         bytes_of_number(static_cast<std::uint32_t>(data.size() / height)) + sized(data);
}

/// sensor_msgs/CompressedImage.
inline std::string ros_compressed(double stamp_s, const std::string& frame,
                                  const std::string& format, const std::string& data) {
  return ros_header(stamp_s, frame) + sized(format) + sized(data);
}

/// sensor_msgs/CameraInfo without distortion.
inline std::string ros_camera_info(std::uint32_t width, std::uint32_t height, double focal_px) {
  std::string bytes = ros_header(0.0, "camera") + bytes_of_number(height) + bytes_of_number(width) +
                      sized("plumb_bob") + bytes_of_number(0u);
  for (double k : {focal_px, 0.0, width / 2.0, 0.0, focal_px, height / 2.0, 0.0, 0.0, 1.0})
    bytes += bytes_of_number(k);
  return bytes + std::string(9 * 8 + 12 * 8 + 8 + 17, '\0');
}

}  // namespace touchtrace::testing
