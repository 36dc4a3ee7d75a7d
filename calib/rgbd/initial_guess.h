#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Initial focal length (square pixels, centred principal point, no distortion) and a pose for each
/// view. Perspective lenses: focal length from homographies (Zhang 2000). Fisheyes: the one of 8
/// focal lengths whose poses have the smallest residuals. The depth camera keeps its defaults.
RgbdParameters initial_guess(const BoardObservations& observations, const Lens& lens);

}  // namespace touchtrace
