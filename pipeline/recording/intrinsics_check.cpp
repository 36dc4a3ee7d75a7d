#include "pipeline/recording/intrinsics_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

// Distance of the principal point from the centre, over the image's size. Images that are cropped
// along one axis have a larger one along that axis alone.
constexpr double max_offset = 0.4, max_offset_of_both = 0.12;
// Focal length over the image's longer side: views of 136 and 6 degrees.
constexpr double min_focal_ratio = 0.2, max_focal_ratio = 10.0;
constexpr double max_focal_difference = 1.5;  // ratio of fx and fy
constexpr double similar_scale = 1.15;        // of the sizes that both coordinates suggest

bool is_within(double value, double least, double most) { return value >= least && value <= most; }

/// Size of the images whose centre is the principal point, if it has the proportions of these.
std::string likely_size(const Camera& camera) {
  const double across = 2.0 * camera.cx / camera.width, down = 2.0 * camera.cy / camera.height;
  if (!is_within(across / down, 1.0 / similar_scale, similar_scale))
    return "they may be those of another camera";
  return fmt::format("they may be those of images of about {:.0f} x {:.0f} pixels, before scaling",
                     2.0 * camera.cx, 2.0 * camera.cy);
}

std::string principal_point_fault(const Camera& camera) {
  const double across = std::abs(camera.cx / camera.width - 0.5),
               down = std::abs(camera.cy / camera.height - 0.5);
  if (std::max(across, down) < max_offset && std::min(across, down) < max_offset_of_both) return {};
  return fmt::format(
      "the principal point ({:.1f}, {:.1f}) is far from the centre of images of {} x {} pixels; {}",
      camera.cx, camera.cy, camera.width, camera.height, likely_size(camera));
}

std::string focal_length_fault(const Camera& camera) {
  const double size = std::max(camera.width, camera.height);
  if (is_within(camera.fx / size, min_focal_ratio, max_focal_ratio) &&
      is_within(camera.fx / camera.fy, 1.0 / max_focal_difference, max_focal_difference))
    return {};
  return fmt::format(
      "focal lengths of {:.4g} and {:.4g} pixels do not suit images of {} x {} pixels; they may be "
      "in another unit, or those of images of another size",
      camera.fx, camera.fy, camera.width, camera.height);
}

}  // namespace

std::string implausible_intrinsics(const Camera& camera) {
  const std::string fault = principal_point_fault(camera);
  return fault.empty() ? focal_length_fault(camera) : fault;
}

std::vector<std::string> implausible_intrinsics(const CameraInfo& info) {
  std::vector<std::string> faults;
  for (const auto& [name, camera] :
       {std::pair{"colour", &info.color_camera}, {"depth", &info.depth_camera}}) {
    if (!*camera || (camera == &info.depth_camera && info.is_registered && info.color_camera))
      continue;
    if (const auto fault = implausible_intrinsics(**camera); !fault.empty())
      faults.push_back(fmt::format("intrinsics of the {} camera: {}", name, fault));
  }
  return faults;
}

}  // namespace touchtrace
