#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Why intrinsics cannot be those of images of their size, with the likely cause; empty: they can.
std::string implausible_intrinsics(const Camera& camera);

/// Implausible intrinsics of the cameras that the driver describes, each with the camera's name.
std::vector<std::string> implausible_intrinsics(const CameraInfo& info);

}  // namespace touchtrace
