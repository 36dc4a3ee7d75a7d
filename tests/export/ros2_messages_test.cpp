#include "pipeline/export/ros2_messages.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numeric>
#include <vector>

namespace touchtrace {
namespace {

std::string hexadecimal(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

/// Messages that rosbags serialized (make_cdr_messages.py), by type.
std::map<std::string, std::string> reference_messages() {
  std::map<std::string, std::string> messages;
  std::ifstream file(TOUCHTRACE_SOURCE_DIR "/tests/export/cdr_messages.txt");
  for (std::string name, bytes; file >> name >> bytes;) messages[name] = bytes;
  return messages;
}

RosHeader header(const char* frame) { return {1'700'000'000'250'000'001, frame}; }

TEST(Ros2Messages, AreThoseOfRosbags) {
  const auto expected = reference_messages();
  std::array<double, 36> covariance;
  std::iota(covariance.begin(), covariance.end(), 0.0);
  const RosBodyState state{{0.5, -0.25, 2.0}, {1.0, 2.0, -3.0}, covariance};
  std::vector<std::uint8_t> pixels(12);
  std::iota(pixels.begin(), pixels.end(), std::uint8_t{0});
  Camera camera{8, 6, 7.5, 7.25, 4.0, 3.0, Radtan4{}};
  camera.distortion[0] = 0.5, camera.distortion[1] = 0.25;
  EXPECT_EQ(hexadecimal(point_stamped(header("camera"), state.position_m)),
            expected.at(point_stamped_type().name));
  EXPECT_EQ(hexadecimal(odometry(header("camera"), "hand", state)),
            expected.at(odometry_type().name));
  EXPECT_EQ(hexadecimal(image(header("glove0"), 3, 2, "16UC1", pixels)),
            expected.at(image_type().name));
  EXPECT_EQ(hexadecimal(camera_info(header("c"), camera)), expected.at(camera_info_type().name));
}

}  // namespace
}  // namespace touchtrace
