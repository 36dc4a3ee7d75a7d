#pragma once

#include <string>

#include "calib/camera/pinhole.h"

namespace touchtrace {

/// A camera as a ROS camera_info YAML document (camera_calibration_parsers): keys in its order,
/// numbers written as floats, distortion model plumb_bob.
std::string camera_info_yaml(const std::string& camera_name, const PinholeCamera& camera);

}  // namespace touchtrace
