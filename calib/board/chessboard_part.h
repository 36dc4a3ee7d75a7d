#pragma once

#include <optional>

#include "calib/board/corner_lattice.h"

namespace touchtrace {

/// Corners of a plain chessboard of which an image shows a part.
struct ChessboardPart {
  /// The board ends after corner `corner` in the direction `step`.
  struct End {
    std::size_t corner;
    LatticeCell step;
  };

  std::vector<Eigen::Vector2d> corners_px;
  std::vector<LatticeCell> cells;  ///< [corners]
  std::vector<End> ends;           ///< from two corners on for each direction
  /// CornerSquares::is_main_dark() at cell (0, 0); nullopt: not known.
  std::optional<bool> is_main_dark = std::nullopt;
};

/// Finds a part of at least 9 corners. A square that findChessboardCornersSB finds with
/// CALIB_CB_LARGER is continued by grow(). nullopt if there is none.
std::optional<ChessboardPart> find_chessboard_part(const GreyImage& image);

/// CornerSquares::is_main_dark() at corner 0 of a board all of whose corners are known, according
/// to most corners; nullopt if they do not tell.
std::optional<bool> is_corner_0_main_dark(const GreyImage& image, const CalibrationTarget& board,
                                          const std::vector<Eigen::Vector2d>& corners_px);

/// Board indices [corners] of the part for every place on the board, in any of four orientations,
/// that agrees with its ends and, if `is_main_dark` is known, with the colours of the squares.
std::vector<std::vector<int>> possible_places(const ChessboardPart& part,
                                              const CalibrationTarget& board,
                                              std::optional<bool> is_main_dark);

}  // namespace touchtrace
