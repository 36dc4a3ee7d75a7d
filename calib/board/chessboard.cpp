#include "calib/board/chessboard.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board/chessboard_part.h"
#include "calib/board/image_matrix.h"
#include "calib/board/interpolated_grey.h"
#include "calib/board/reduced_image.h"
#include "calib/board/upscaled_image.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int large_image_px = 2000;
constexpr int min_corners_per_side = 3;
constexpr int num_profile_steps = 64;
/// Fraction of a board's corners. In public photographs 1 or 2 of 54 had no saddle.
constexpr double min_saddle_fraction = 0.75;
constexpr double min_contrast = 20.0;  ///< [grey levels] of an edge whose width can be measured

std::vector<Eigen::Vector2d> find_in_upscaled(const UpscaledImage& image,
                                              const CalibrationTarget& board) {
  std::vector<cv::Point2f> points;
  cv::setRNGSeed(0);  // its search is random: the corners must not depend on earlier images
  if (!cv::findChessboardCornersSB(image.pixels, {board.columns, board.rows}, points)) return {};
  std::vector<Eigen::Vector2d> corners;
  for (const auto& p : points) corners.push_back(image.to_original(p));
  return corners;
}

/// Corners [rows][columns] of a square board, turned by a quarter.
std::vector<Eigen::Vector2d> quarter_turned(const std::vector<Eigen::Vector2d>& corners, int side) {
  std::vector<Eigen::Vector2d> result;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      result.push_back(corners[static_cast<std::size_t>((side - 1 - column) * side + row)]);
  return result;
}

/// Orders corners so that the first one has the same squares around it in every view. This leaves
/// one order of a board that is not symmetric, and two of a square board of odd sides, half a turn
/// apart.
void order_by_colors(std::vector<Eigen::Vector2d>& corners, const GreyImage& image,
                     const CalibrationTarget& board) {
  const auto is_main_dark = is_corner_0_main_dark(image, board, corners);
  if (!is_main_dark) return;
  const bool is_odd_square = board.columns == board.rows && board.columns % 2 == 1;
  if (!board.is_symmetric() && *is_main_dark) std::ranges::reverse(corners);
  if (is_odd_square && !*is_main_dark) corners = quarter_turned(corners, board.columns);
}

/// Grey values from the centre of one square, across the middle of an edge, to that of the next.
/// `across`: side of a square, perpendicular to the edge.
std::vector<double> edge_profile(const GreyImage& image, const Eigen::Vector2d& middle,
                                 const Eigen::Vector2d& across) {
  std::vector<double> profile;
  for (int i = 0; i <= num_profile_steps; ++i)
    profile.push_back(
        interpolated_grey(image, middle + (double(i) / num_profile_steps - 0.5) * across));
  return profile;
}

/// Fraction of the profile over which it rises, or falls, from 10 to 90 %. NaN if it has no
/// contrast.
double rise_width(std::vector<double> profile) {
  if (profile.front() > profile.back()) std::ranges::reverse(profile);
  const double low = profile.front(), contrast = profile.back() - low;
  if (!(contrast >= min_contrast)) return std::numeric_limits<double>::quiet_NaN();
  const auto crossing = [&](double level) {
    const auto above =
        std::ranges::find_if(profile, [&](double grey) { return grey >= low + level * contrast; });
    if (above == profile.begin()) return 0.0;
    const double before = *(above - 1);
    return double(above - profile.begin()) - 1.0 +
           (low + level * contrast - before) / (*above - before);
  };
  return (crossing(0.9) - crossing(0.1)) / num_profile_steps;
}

/// The corners that are saddle points, refined, with their indices on the board; {} if many are
/// none: what was found is not the board. `factor`: by which the image was reduced.
TargetCorners saddle_corners(const std::vector<Eigen::Vector2d>& corners, int factor,
                             const GreyImage& image) {
  const auto refined = refined_corners(corners, factor, image);
  TargetCorners found;
  for (std::size_t i = 0; i < refined.size(); ++i)
    if (refined[i]) {
      found.corners_px.push_back(*refined[i]);
      found.ids.push_back(static_cast<int>(i));
    }
  if (found.corners_px.size() < min_saddle_fraction * static_cast<double>(corners.size()))
    return {};
  if (found.corners_px.size() == corners.size()) found.ids.clear();
  return found;
}

/// findChessboardCornersSB() in an upscaled image, in the board's order.
std::vector<Eigen::Vector2d> find_by_sectors(const GreyImage& image,
                                             const CalibrationTarget& board) {
  auto corners = find_in_upscaled({image, default_upscale_factor(image)}, board);
  if (!corners.empty()) order_by_colors(corners, image, board);
  return corners;
}

/// Least and largest coordinate of cells.
std::pair<int, int> minmax_of(const std::vector<LatticeCell>& cells, int axis) {
  const auto [least, largest] =
      std::ranges::minmax(cells, {}, [&](const LatticeCell& cell) { return cell[axis]; });
  return {least[axis], largest[axis]};
}

}  // namespace

double relative_edge_width(const GreyImage& image, const std::vector<Eigen::Vector2d>& corners,
                           const CalibrationTarget& board) {
  std::vector<double> widths;
  for (int row = 0; row + 1 < board.rows; ++row)
    for (int column = 0; column + 1 < board.columns; ++column) {
      const auto corner = static_cast<std::size_t>(row * board.columns + column);
      const Eigen::Vector2d &here = corners[corner], &right = corners[corner + 1],
                            &below = corners[corner + static_cast<std::size_t>(board.columns)];
      widths.push_back(rise_width(edge_profile(image, 0.5 * (here + right), below - here)));
      widths.push_back(rise_width(edge_profile(image, 0.5 * (here + below), right - here)));
    }
  std::erase_if(widths, [](double width) { return std::isnan(width); });
  return widths.empty() ? std::numeric_limits<double>::quiet_NaN() : median(std::move(widths));
}

TargetCorners find_chessboard_by_squares(const GreyImage& image, const CalibrationTarget& board) {
  const ReducedImage reduced(image);
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCorners(as_matrix(reduced.image), {board.columns, board.rows}, points,
                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return {};
  std::vector<Eigen::Vector2d> corners;
  for (const auto& p : points) corners.emplace_back(p.x, p.y);
  corners = to_original(std::move(corners), reduced);
  order_by_colors(corners, image, board);
  return saddle_corners(corners, reduced.factor, image);
}

TargetCorners find_chessboard(const GreyImage& image, const CalibrationTarget& board) {
  std::vector<Eigen::Vector2d> corners;
  TargetCorners saddles, found;
  if (std::max(image.width, image.height) > large_image_px) {
    const ReducedImage reduced(image);
    corners = to_original(find_by_sectors(reduced.image, board), reduced);
    found = saddles = saddle_corners(corners, reduced.factor, image);
  } else {
    corners = find_by_sectors(image, board);
    saddles = saddle_corners(corners, 1, image);
    found = {corners, {}};
  }
  if (!corners.empty() && saddles.corners_px.size() == corners.size()) return found;
  // a grid that is shifted or turned has corners on the board's outer edge
  auto by_squares = find_chessboard_by_squares(image, board);
  return by_squares.corners_px.empty() ? found : by_squares;
}

namespace {

std::optional<OtherTarget> find_other(const GreyImage& image, const CalibrationTarget& asked) {
  const auto seen = find_board_size(image);
  if (!seen ||
      *seen == BoardSize{std::max(asked.columns, asked.rows), std::min(asked.columns, asked.rows)})
    return {};
  return OtherTarget{fmt::format("no board of {}x{} inner corners but one of {}x{}", asked.columns,
                                 asked.rows, seen->columns, seen->rows),
                     fmt::format("leave out --columns and --rows, or give --columns {} --rows {}: "
                                 "they count inner corners",
                                 seen->columns, seen->rows)};
}

std::optional<OtherTarget> recognize(const GreyImage& image) {
  const auto seen = find_board_size(image);
  if (!seen) return {};
  return OtherTarget{fmt::format("a chessboard of {}x{} inner corners", seen->columns, seen->rows),
                     "leave out --target, --markers, --columns and --rows"};
}

}  // namespace

const TargetKind chessboard_kind{
    .name = "chessboard",
    .element = "inner corners",
    .element_corners = 1,
    .place_m = square_lattice_m,
    .is_symmetric =
        [](const CalibrationTarget& board) { return (board.columns + board.rows) % 2 == 0; },
    .find_corners = find_chessboard,
    .find_other = find_other,
    .recognize = recognize,
};

std::optional<BoardSize> find_board_size(const GreyImage& image) {
  const auto part = find_chessboard_part(ReducedImage(image).image);
  if (!part) return {};
  const auto [first_column, last_column] = minmax_of(part->cells, 0);
  const auto [first_row, last_row] = minmax_of(part->cells, 1);
  const int columns = last_column - first_column + 1, rows = last_row - first_row + 1;
  const bool is_filled = static_cast<int>(part->cells.size()) == columns * rows;
  if (!is_filled || std::min(columns, rows) < min_corners_per_side) return {};
  return BoardSize{std::max(columns, rows), std::min(columns, rows)};
}

}  // namespace touchtrace
