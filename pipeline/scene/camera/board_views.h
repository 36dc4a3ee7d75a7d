#pragma once

#include <vector>

#include "pipeline/scene/camera/camera_model.h"

namespace touchtrace::scene {

/// Random poses `color_from_board` of a chessboard shown by a user: spread over the image, at 0.4
/// to 1.2 m, tilted up to 45 degrees, entirely in both images, with squares at least 8 px wide. May
/// return fewer than `count`. Board frame: inner corners centred on the origin, z away from the
/// camera.
std::vector<Eigen::Isometry3d> board_poses(const RgbdCamera& camera, const BoardInfo& board,
                                           int count, std::uint64_t seed);

}  // namespace touchtrace::scene
