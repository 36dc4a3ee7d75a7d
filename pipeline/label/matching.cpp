#include "pipeline/label/matching.h"

#include <fmt/core.h>

#include "engine/base/error.h"

namespace touchtrace::label {
namespace {

void require_size(const char* kind, const Camera& calibrated, int width, int height) {
  if (calibrated.width == width && calibrated.height == height) return;
  throw data_error(
      fmt::format(
          "calibration of the {} camera is for images of {} x {}, the recording has {} x {}", kind,
          calibrated.width, calibrated.height, width, height),
      "calibrate the camera that recorded, with images of this size");
}

}  // namespace

void require_matching(const RgbdCalibration& calibration, const CameraInfo& camera) {
  require_size("colour", calibration.color, camera.width, camera.height);
  if (calibration.depth)
    require_size("depth", *calibration.depth, camera.depth_image_width(),
                 camera.depth_image_height());
}

}  // namespace touchtrace::label
