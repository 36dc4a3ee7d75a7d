#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Focal lengths from the homographies (Zhang 2000, square pixels, centred principal point, no
/// distortion) and one pose for each view. The depth camera keeps its defaults.
RgbdParameters initial_guess(const BoardObservations& observations);

}  // namespace touchtrace
