#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Focal length (square pixels, centred principal point, no distortion) and one pose for each view.
/// Of a perspective lens from the homographies (Zhang 2000); of a fisheye the one of a few focal
/// lengths that leaves least when the boards are placed by it. The depth camera keeps its defaults.
RgbdParameters initial_guess(const BoardObservations& observations, const Lens& lens);

}  // namespace touchtrace
