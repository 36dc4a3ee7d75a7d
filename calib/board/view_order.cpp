#include "calib/board/view_order.h"

#include <algorithm>

namespace touchtrace {

Eigen::Vector2d diagonal_px(const BoardView& view, const CalibrationTarget& board) {
  return image_scale_px_per_m({view.corners_px, view.corner_ids}, board) * board.size_m();
}

void turn_by_half(BoardView& view, const CalibrationTarget& board) {
  if (view.corner_ids.empty()) std::ranges::reverse(view.corners_px);
  for (int& id : view.corner_ids) id = board.num_corners() - 1 - id;
}

void align_symmetric_views(BoardObservations& observations) {
  const CalibrationTarget& board = observations.board;
  if (!board.is_symmetric() || observations.views.empty()) return;
  const Eigen::Vector2d first_px = diagonal_px(observations.views.front(), board);
  for (BoardView& view : observations.views)
    if (diagonal_px(view, board).dot(first_px) < 0.0) turn_by_half(view, board);
}

}  // namespace touchtrace
