#pragma once

#include <vector>

#include "pipeline/scene/camera/camera_model.h"

namespace touchtrace::scene {

/// Poses `color_from_board` in which a user shows the chessboard: spread over the image and over
/// distances of 0.4 to 1.2 m, tilted up to 45 degrees, every corner in both images and squares wide
/// enough to be found. The board's frame: inner corners around the origin, z away from the camera.
std::vector<Eigen::Isometry3d> board_poses(const RgbdCamera& camera, const BoardInfo& board,
                                           int count, std::uint64_t seed);

}  // namespace touchtrace::scene
