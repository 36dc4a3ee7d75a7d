#include "pipeline/acquire/import/resized_depth.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

bool has_same_aspect(cv::Size color, cv::Size depth) {
  const double height = static_cast<double>(color.height) * depth.width / color.width;
  return std::abs(height - depth.height) <= 1.0;
}

Camera resized(Camera camera, cv::Size size) {
  const double x = static_cast<double>(size.width) / camera.width,
               y = static_cast<double>(size.height) / camera.height;
  camera.width = size.width, camera.height = size.height;
  camera.fx *= x, camera.fy *= y;
  camera.cx = (camera.cx + 0.5) * x - 0.5, camera.cy = (camera.cy + 0.5) * y - 0.5;
  return camera;
}

}  // namespace

Camera resized_depth_camera(const std::optional<Camera>& color_camera, cv::Size color,
                            cv::Size depth) {
  const auto sizes = fmt::format("depth of {}x{} pixels, colour of {}x{}", depth.width,
                                 depth.height, color.width, color.height);
  if (!has_same_aspect(color, depth))
    throw data_error(
        fmt::format("registered depth images have the size or the aspect ratio of the colour "
                    "images, these do not: {}",
                    sizes),
        "leave out --registered");
  if (!color_camera)
    throw data_error(fmt::format("registered depth images of another size need the intrinsics of "
                                 "the colour camera, which are unknown: {}",
                                 sizes),
                     "give --camera-info FILE");
  Progress::report(
      fmt::format("{}: the depth camera gets the colour camera's pose, and its "
                  "intrinsics scaled to the size of the depth images",
                  sizes));
  return resized(*color_camera, depth);
}

}  // namespace touchtrace
