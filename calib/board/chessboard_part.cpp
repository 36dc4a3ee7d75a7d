#include "calib/board/chessboard_part.h"

#include <Eigen/LU>
#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "calib/board/upscaled_image.h"

namespace touchtrace {
namespace {

constexpr int seed_corners = 3;         ///< per side, the least that OpenCV accepts
constexpr std::size_t min_corners = 9;  ///< as in the seed
constexpr std::size_t min_ends = 2;
constexpr int max_seeds = 5;

/// Rectangle of corners that OpenCV finds. Rows or columns in between may be missing. OpenCV's
/// search is random.
CornerLattice find_seed(const UpscaledImage& enlarged, int random_seed) {
  std::vector<cv::Point2f> points;
  cv::Mat meta;
  cv::setRNGSeed(random_seed);
  if (!cv::findChessboardCornersSB(enlarged.pixels, {seed_corners, seed_corners}, points,
                                   cv::CALIB_CB_LARGER, meta))
    return {};
  CornerLattice seed;
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    seed[{i % meta.cols, i / meta.cols}] = enlarged.to_original(points[std::size_t(i)]);
  return seed;
}

/// Four corners of the seed at `cell`, clockwise, if they are those of one square; else empty.
CornerLattice unit_square(const CornerLattice& seed, const GreyImage& image,
                          const LatticeCell& cell) {
  CornerLattice square;
  for (const LatticeCell& at : {LatticeCell{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    const auto corner = seed.find(cell + at);
    if (corner == seed.end()) return {};
    square[at] = corner->second;
  }
  Eigen::Matrix2d sides;
  sides << square[{1, 0}] - square[{0, 0}], square[{0, 1}] - square[{0, 0}];
  if (sides.determinant() < 0.0) std::swap(square[{1, 0}], square[{0, 1}]);
  return is_unit_square(square, image) ? square : CornerLattice{};
}

/// The largest lattice that grows from a square of the seed.
CornerLattice grow_from(const CornerLattice& seed, const GreyImage& image) {
  CornerLattice largest;
  for (const auto& [cell, unused] : seed) {
    if (2 * largest.size() >= seed.size()) break;
    CornerLattice lattice = unit_square(seed, image, cell);
    if (lattice.empty()) continue;
    grow(lattice, image);
    if (lattice.size() > largest.size()) largest = std::move(lattice);
  }
  return largest;
}

/// Lattice of the first of a few seeds from which one grows.
CornerLattice find_lattice(const GreyImage& image) {
  const UpscaledImage enlarged(image, default_upscale_factor(image));
  CornerLattice lattice;
  for (int attempt = 0; attempt < max_seeds && lattice.size() < min_corners; ++attempt) {
    const CornerLattice seed = find_seed(enlarged, attempt);
    if (seed.empty()) break;
    lattice = grow_from(seed, image);
  }
  return lattice;
}

std::vector<ChessboardPart::End> find_ends(const CornerLattice& lattice, const GreyImage& image) {
  std::vector<ChessboardPart::End> all;
  for (const LatticeCell& step : lattice_steps) {
    std::vector<ChessboardPart::End> ends;
    std::size_t corner = 0;
    for (const auto& [cell, unused] : lattice) {
      if (is_end_of_board(lattice, image, cell, step)) ends.push_back({corner, step});
      ++corner;
    }
    if (ends.size() >= min_ends) all.insert(all.end(), ends.begin(), ends.end());
  }
  return all;
}

bool is_even(const LatticeCell& cell) { return (cell[0] + cell[1]) % 2 == 0; }

/// CornerSquares::is_main_dark() at cell (0, 0) according to most corners whose squares the image
/// shows; nullopt if it shows none or they disagree.
std::optional<bool> main_dark_of(const GreyImage& image, const CornerLattice& lattice) {
  int balance = 0;
  for (const auto& [cell, unused] : lattice)
    if (const auto squares = squares_around(image, lattice, cell))
      balance += squares->is_main_dark() == is_even(cell) ? 1 : -1;
  return balance == 0 ? std::nullopt : std::optional(balance > 0);
}

/// A place of a part: corner c of the part is at turned(c) + `shift` on the board.
struct Place {
  int quarter_turns;
  LatticeCell shift;

  LatticeCell on_board(const LatticeCell& cell) const {
    return turned(cell, quarter_turns) + shift;
  }
};

bool is_on_board(const LatticeCell& cell, const CalibrationTarget& board) {
  return cell[0] >= 0 && cell[1] >= 0 && cell[0] < board.columns && cell[1] < board.rows;
}

bool agrees(const Place& place, const ChessboardPart& part, const CalibrationTarget& board,
            std::optional<bool> is_main_dark) {
  for (const LatticeCell& cell : part.cells)
    if (!is_on_board(place.on_board(cell), board)) return false;
  for (const auto& [corner, step] : part.ends)
    if (is_on_board(place.on_board(part.cells[corner] + step), board)) return false;
  if (!is_main_dark || !part.is_main_dark) return true;
  // A step or a quarter turn exchanges the dark and the light diagonal.
  const bool is_exchanged = is_even(place.shift) == (place.quarter_turns % 2 == 1);
  return *is_main_dark == (*part.is_main_dark != is_exchanged);
}

}  // namespace

std::optional<ChessboardPart> find_chessboard_part(const GreyImage& image) {
  const CornerLattice lattice = find_lattice(image);
  if (lattice.size() < min_corners) return {};
  ChessboardPart part;
  for (const auto& [cell, corner_px] : lattice) {
    part.cells.push_back(cell);
    part.corners_px.push_back(corner_px);
  }
  part.is_main_dark = main_dark_of(image, lattice);
  part.ends = find_ends(lattice, image);
  return part;
}

std::optional<bool> is_corner_0_main_dark(const GreyImage& image, const CalibrationTarget& board,
                                          const std::vector<Eigen::Vector2d>& corners_px) {
  CornerLattice lattice;
  for (int i = 0; i < board.num_corners(); ++i)
    lattice[{i % board.columns, i / board.columns}] = corners_px[std::size_t(i)];
  return main_dark_of(image, lattice);
}

std::vector<std::vector<int>> possible_places(const ChessboardPart& part,
                                              const CalibrationTarget& board,
                                              std::optional<bool> is_main_dark) {
  std::vector<std::vector<int>> places;
  for (int quarter_turns = 0; quarter_turns < 4; ++quarter_turns)
    for (int id = 0; id < board.num_corners(); ++id) {
      // The place that puts corner 0 of the part at `id`.
      const LatticeCell first{id % board.columns, id / board.columns};
      const Place place{quarter_turns, first - turned(part.cells[0], quarter_turns)};
      if (!agrees(place, part, board, is_main_dark)) continue;
      auto& ids = places.emplace_back();
      for (const LatticeCell& cell : part.cells) {
        const LatticeCell at = place.on_board(cell);
        ids.push_back(at[1] * board.columns + at[0]);
      }
    }
  return places;
}

}  // namespace touchtrace
