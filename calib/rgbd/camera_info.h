#pragma once

#include <string>

#include "calib/camera/camera.h"

namespace touchtrace {

/// ROS camera_info YAML (camera_calibration_parsers): keys in its order, all matrix entries as
/// floats, distortion model plumb_bob, rational_polynomial or equidistant.
std::string camera_info_yaml(const std::string& camera_name, const Camera& camera);

}  // namespace touchtrace
