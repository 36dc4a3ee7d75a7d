#pragma once

#include <vector>

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

/// Static background: wall, floor, table, shelf and things on them.
std::vector<PaintedSolid> room_solids();

/// The person behind the hand, without the forearm that moves with the hand: torso, head, legs,
/// right upper arm, left arm. Head and left arm sway slowly.
std::vector<PaintedSolid> person_solids(double time_s);

/// Chessboard of (columns + 1) x (rows + 1) squares with a white margin of one square, in its x-y
/// plane; the inner corners are centred on the origin, columns along x.
PaintedSolid board_solid(const BoardInfo& board, const Eigen::Isometry3d& world_from_board);

}  // namespace touchtrace::scene
