#pragma once

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

/// What never moves: wall, floor, table, and things on and behind it.
std::vector<PaintedSolid> room_solids();

/// The person behind the hand, without the forearm that physics moves: torso, head, legs, the upper
/// part of the right arm, and the left arm. Head and left arm sway slowly with time.
std::vector<PaintedSolid> person_solids(double time_s);

/// A board of (columns + 1) x (rows + 1) squares with a white margin of one square, in its own x-y
/// plane; the inner corners lie around the origin, columns along x.
PaintedSolid board_solid(const BoardInfo& board, const Eigen::Isometry3d& world_from_board);

}  // namespace touchtrace::scene
