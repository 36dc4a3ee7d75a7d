#include "calib/board/board_detector.h"

#include <fmt/core.h>

#include <algorithm>

#include "calib/board/chessboard.h"
#include "calib/board/view_order.h"

namespace touchtrace {
bool BoardDetector::add(BoardView view, const GreyImage& image) {
  const CalibrationTarget& board = observations_.board;
  observations_.width = image.width, observations_.height = image.height;
  std::tie(view.corners_px, view.corner_ids) = board.kind->find_corners(image, board);
  if (view.corners_px.empty()) return add_part(std::move(view), image);
  if (board.kind == &chessboard_kind) {
    view.relative_edge_width = relative_edge_width(image, view.corners_px, board);
    if (!is_main_dark_) is_main_dark_ = is_corner_0_main_dark(image, board, view.corners_px);
  }
  observations_.views.push_back(std::move(view));
  return true;
}

bool BoardDetector::add_part(BoardView view, const GreyImage& image) {
  if (observations_.board.kind == &chessboard_kind)
    if (auto part = find_chessboard_part(image);
        part && !possible_places(*part, observations_.board, {}).empty()) {
      partial_views_.push_back({std::move(view), std::move(*part)});
      return true;
    }
  observations_.views_without_board.push_back(std::move(view.name));
  return false;
}

void BoardDetector::place(BoardView view, const ChessboardPart& part) {
  const CalibrationTarget& board = observations_.board;
  view.corners_px = part.corners_px;
  auto places = possible_places(part, board, is_main_dark_);
  if (board.is_symmetric() && !observations_.views.empty()) {
    const Eigen::Vector2d first_px = diagonal_px(observations_.views.front(), board);
    std::erase_if(places, [&](const std::vector<int>& ids) {
      view.corner_ids = ids;
      return diagonal_px(view, board).dot(first_px) < 0.0;
    });
  }
  if (places.size() != 1) {
    observations_.skipped.push_back(
        {view.name, "shows a part of the board that fits in several places"});
    return;
  }
  view.corner_ids = std::move(places.front());
  observations_.views.push_back(std::move(view));
}

BoardObservations BoardDetector::finish() && {
  for (auto& [view, part] : partial_views_) place(std::move(view), part);
  return std::move(observations_);
}

}  // namespace touchtrace
