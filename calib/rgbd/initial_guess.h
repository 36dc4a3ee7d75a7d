#pragma once

#include "calib/camera/camera.h"
#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Initial focal length (square pixels, centred principal point, no distortion) and a pose for each
/// view. Perspective lenses: focal length from homographies (Zhang 2000). Fisheyes: the one of 8
/// focal lengths whose poses have the smallest residuals. The depth camera keeps its defaults.
RgbdParameters initial_guess(const BoardObservations& observations, const Lens& lens);

/// camera_from_board of a view, from its corners within 80 degrees of the optical axis. If these
/// are degenerate: 1 m in front of the camera.
std::array<double, 6> initial_pose(const BoardView& view, const CalibrationTarget& board,
                                   const Camera& camera);

}  // namespace touchtrace
