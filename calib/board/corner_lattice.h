#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "calib/board/board_view.h"

namespace touchtrace {

/// Column and row of a corner. The origin is arbitrary; x to y is clockwise in the image.
using LatticeCell = std::array<int, 2>;

/// Connected corners of a chessboard in an image [px].
using CornerLattice = std::map<LatticeCell, Eigen::Vector2d>;

inline LatticeCell operator+(const LatticeCell& a, const LatticeCell& b) {
  return {a[0] + b[0], a[1] + b[1]};
}
inline LatticeCell operator-(const LatticeCell& a, const LatticeCell& b) {
  return {a[0] - b[0], a[1] - b[1]};
}

/// Steps to the four neighbours of a corner.
inline constexpr LatticeCell lattice_steps[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

/// Cell turned by quarter turns about (0, 0), clockwise.
inline LatticeCell turned(LatticeCell cell, int quarter_turns) {
  for (int i = 0; i < quarter_turns; ++i) cell = {-cell[1], cell[0]};
  return cell;
}

/// A corner that is not known yet, and the sides of the squares around it.
struct PredictedCorner {
  Eigen::Vector2d at_px, x_px, y_px;

  double min_side_px() const { return std::min(x_px.norm(), y_px.norm()); }
};

/// Predicts the corner one step after `cell` by the homography of a square before it; nullopt if
/// no such square is known.
std::optional<PredictedCorner> predict_corner(const CornerLattice& lattice, const LatticeCell& cell,
                                              const LatticeCell& step);

/// Grey values of the four squares around a corner.
class CornerSquares {
 public:
  /// Samples the squares at a quarter of their sides from `corner_px`. `x_px` and `y_px`: sides
  /// from there, along rows and columns. nullopt if a sample is outside the image.
  static std::optional<CornerSquares> sample(const GreyImage& image,
                                             const Eigen::Vector2d& corner_px,
                                             const Eigen::Vector2d& x_px,
                                             const Eigen::Vector2d& y_px);
  /// Brightness of the square in the direction (x, y); each 1 or -1.
  double at(int x, int y) const { return grey_[x > 0][y > 0]; }
  /// Darkest light square minus brightest dark one; positive at a corner. `is_main_dark`: the
  /// squares at (1, 1) and (-1, -1) are the dark ones.
  double contrast(bool is_main_dark) const;
  /// True if (1, 1) and (-1, -1) are darker than the others.
  bool is_main_dark() const { return at(1, 1) + at(-1, -1) < at(1, -1) + at(-1, 1); }

 private:
  std::array<std::array<double, 2>, 2> grey_;
};

/// Squares around a known corner; nullopt if it has no neighbour along its row or column.
std::optional<CornerSquares> squares_around(const GreyImage& image, const CornerLattice& lattice,
                                            const LatticeCell& cell);

/// True if the corners (0, 0), (1, 0), (0, 1) and (1, 1) are those of one square: their squares
/// alternate, and the centre has the colour that it has at the corners.
bool is_unit_square(const CornerLattice& corners, const GreyImage& image);

/// Adds all corners of the image that continue the lattice. A corner is accepted if
/// refine_saddle_point() converges near the place that its neighbours predict, and if the contrast
/// of its squares is more than half that of its neighbour's: at the outer border of a board it is
/// 0, because three of the four squares are white.
void grow(CornerLattice& lattice, const GreyImage& image);

/// True if the board ends after `cell` in the direction `step`: behind its next square, where
/// grow() found no corner, is the white border.
bool is_end_of_board(const CornerLattice& lattice, const GreyImage& image, const LatticeCell& cell,
                     const LatticeCell& step);

}  // namespace touchtrace
