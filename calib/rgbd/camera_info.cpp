#include "calib/rgbd/camera_info.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>
#include <span>

namespace touchtrace {
namespace {

std::string matrix(const char* key, int rows, int cols, std::span<const double> data) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{:#}]\n", key, rows, cols,
                     fmt::join(data, ", "));
}

}  // namespace

std::string camera_info_yaml(const std::string& camera_name, const Camera& c) {
  const LensInterop interop = lens_interop(c.lens);
  const std::array<double, 9> intrinsics{c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  const std::array<double, 9> rectification{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 12> projection{c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0};
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", c.width, c.height,
                     camera_name) +
         matrix("camera_matrix", 3, 3, intrinsics) +
         fmt::format("distortion_model: {}\n", interop.ros) +
         matrix("distortion_coefficients", 1, interop.num_ros_coefficients,
                {c.distortion.data(), static_cast<std::size_t>(interop.num_ros_coefficients)}) +
         matrix("rectification_matrix", 3, 3, rectification) +
         matrix("projection_matrix", 3, 4, projection);
}

}  // namespace touchtrace
