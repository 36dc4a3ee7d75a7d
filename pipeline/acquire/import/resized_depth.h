#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calib/camera/camera.h"

namespace touchtrace {

/// Camera of depth images that show the colour camera's view at another size, as those of phones
/// do: the colour camera with intrinsics scaled to that size; its pixels cover the same area.
/// Throws data_error if the aspect ratios differ by more than a pixel or if there is no colour
/// camera.
Camera resized_depth_camera(const std::optional<Camera>& color_camera, cv::Size color,
                            cv::Size depth);

}  // namespace touchtrace
