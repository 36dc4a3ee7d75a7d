#pragma once

#include <string>

#include "calib/camera/camera.h"

namespace touchtrace {

/// A camera as a ROS camera_info YAML document (camera_calibration_parsers): keys in its order,
/// numbers written as floats, distortion model plumb_bob, rational_polynomial or equidistant.
std::string camera_info_yaml(const std::string& camera_name, const Camera& camera);

}  // namespace touchtrace
