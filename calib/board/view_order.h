#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Direction in the image [px] from corner 0 of the board to its last corner, by the best affine
/// map of the corners that the view shows.
Eigen::Vector2d diagonal_px(const BoardView& view, const CalibrationTarget& board);

/// Numbers the corners as after half a turn of the board: corner i becomes corner n - 1 - i.
void turn_by_half(BoardView& view, const CalibrationTarget& board);

/// Turns the views of a symmetric board whose diagonal_px() is more than 90 degrees from that of
/// the first view, so that a corner of the board has one index in all views.
void align_symmetric_views(BoardObservations& observations);

}  // namespace touchtrace
