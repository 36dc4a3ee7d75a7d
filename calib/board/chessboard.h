#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Width over which the edges of the squares rise from 10 to 90 %, over the side of a square;
/// median over the board. `corners`: all of the board. NaN if the edges have no contrast.
double relative_edge_width(const GreyImage& image, const std::vector<Eigen::Vector2d>& corners,
                           const CalibrationTarget& board);

/// Returns the inner corners in the board's order, or {} if the image does not show all of them.
///
/// findChessboardCornersSB (Duda and Frese, BMVC 2018) on an image upscaled to about 1280 pixels:
/// on rendered 320x240 boards this lowers the corner error from 0.12 to 0.02 px. In an image of
/// more than 2000 pixels it looks on a reduced one and refines the corners by
/// refine_saddle_point(). Where it finds nothing, or corners that are no saddle points:
/// find_chessboard_by_squares(), if that finds the board.
TargetCorners find_chessboard(const GreyImage& image, const CalibrationTarget& board);

/// Finds the inner corners with findChessboardCorners() in a reduced image and refines them with
/// refine_saddle_point(). Skips corners that are not saddle points, from glare or blur. In the
/// first photographs of 14 public sets, 166 in all, findChessboardCorners() finds 140 boards,
/// findChessboardCornersSB() 103, and 120 with CALIB_CB_EXHAUSTIVE, of which none is missed by both
/// others.
TargetCorners find_chessboard_by_squares(const GreyImage& image, const CalibrationTarget& board);

/// Inner corners per row and per column.
struct BoardSize {
  int columns, rows;

  auto operator<=>(const BoardSize&) const = default;
};

/// Size of the plain chessboard in an image, columns >= rows, looked for in a reduced image.
/// Smaller than the board if the image shows a rectangular part of it. nullopt if the corners that
/// are seen fill no rectangle.
std::optional<BoardSize> find_board_size(const GreyImage& image);

}  // namespace touchtrace
