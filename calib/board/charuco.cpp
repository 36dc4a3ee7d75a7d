#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <optional>

#include "calib/board/markers.h"
#include "calib/board/saddle.h"
#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr int border_bits = 1;
constexpr int min_radius_px = 2, max_radius_px = 10;
constexpr int min_squares = 3, max_squares = 40;  ///< in a row, of boards that are looked for
constexpr std::size_t min_markers_of_other = 6, min_corners_of_other = 6;
constexpr double min_ratio = 0.3, max_ratio = 0.95, ratio_step = 0.05;  ///< of marker to square

/// Which squares hold the markers 0, 1, ..., along the rows.
struct MarkerLayout {
  int squares_in_row = 0;
  bool is_first_square_white = false;

  bool holds_marker(int column, int row) const {
    return (column + row) % 2 == (is_first_square_white ? 0 : 1);
  }
  int marker_of(int column, int row) const {
    const int in_even_row = (squares_in_row + (is_first_square_white ? 1 : 0)) / 2;
    return row / 2 * squares_in_row + row % 2 * in_even_row + column / 2;
  }
};

void validate(const CalibrationTarget& board) {
  const int squares_x = board.columns + 1, squares_y = board.rows + 1;
  const int available = dictionary_size(board.markers->dictionary);
  if (squares_x * squares_y / 2 > available)
    throw usage_error(
        fmt::format("a board of {}x{} squares needs {} markers; '{}' has {}", squares_x, squares_y,
                    squares_x * squares_y / 2, board.markers->dictionary, available),
        "use the dictionary and the size that the board was printed with");
  if (!(board.markers->side_m < board.square_m))
    throw usage_error(fmt::format("a marker of {:g} mm is not smaller than a square of {:g} mm",
                                  1e3 * board.markers->side_m, 1e3 * board.square_m),
                      "set the side of a marker with --marker-mm");
}

/// Corners that two decoded markers touch, accurate to some tenths of a pixel.
struct RoughCorners {
  TargetCorners corners;
  int num_pairs = 0;  ///< decoded markers that touch in one corner, if the layout is right
};

/// The two markers that touch inner corner (column, row); without them nullopt.
std::optional<std::pair<PlacedMarker, PlacedMarker>> touching_markers(const DecodedMarkers& markers,
                                                                      const MarkerLayout& layout,
                                                                      int column, int row) {
  const bool is_left_above = layout.holds_marker(column, row);
  const int left_row = row + (is_left_above ? 0 : 1), right_row = row + (is_left_above ? 1 : 0);
  const auto* left = markers.find(layout.marker_of(column, left_row));
  const auto* right = markers.find(layout.marker_of(column + 1, right_row));
  if (!left || !right) return {};
  return {{{left, {column, left_row}}, {right, {column + 1.0, right_row}}}};
}

RoughCorners rough_corners(const DecodedMarkers& markers, const MarkerLayout& layout,
                           const CalibrationTarget& board) {
  const double square = board.square_m / board.markers->side_m;  // [sides of a marker]
  const Eigen::Vector2d corner = Eigen::Vector2d::Constant(1.0 - 0.5 * (square - 1.0) / square);
  RoughCorners found;
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column + 2 <= layout.squares_in_row; ++column) {
      auto pair = touching_markers(markers, layout, column, row);
      if (!pair) continue;
      ++found.num_pairs;
      pair->first.place *= square, pair->second.place *= square;
      if (const auto local = homography_of(pair->first, pair->second)) {
        found.corners.corners_px.push_back(
            local->image_of(square * (Eigen::Vector2d(column, row) + corner)));
        found.corners.ids.push_back(row * (layout.squares_in_row - 1) + column);
      }
    }
  return found;
}

/// The layout with most corners among those with `min_in_row` to `max_in_row` squares in a row.
std::pair<MarkerLayout, RoughCorners> best_layout(const DecodedMarkers& markers,
                                                  const CalibrationTarget& board, int min_in_row,
                                                  int max_in_row) {
  std::pair<MarkerLayout, RoughCorners> best;
  for (int in_row = min_in_row; in_row <= max_in_row; ++in_row)
    for (const bool is_white : {false, true}) {
      const MarkerLayout layout{in_row, is_white};
      RoughCorners found = rough_corners(markers, layout, board);
      if (found.corners.ids.size() > best.second.corners.ids.size())
        best = {layout, std::move(found)};
    }
  return best;
}

/// Whether the markers lie as in the layout. A layout whose rows are one square too short or too
/// long is right for up to three fifths of the pairs: the others are in the next row.
bool agrees(const RoughCorners& found) {
  return 5 * static_cast<int>(found.corners.ids.size()) >= 4 * found.num_pairs;
}

/// Radius around a corner that holds no marker, in the direction of the strongest foreshortening.
int marker_free_radius_px(const TargetCorners& found, const CalibrationTarget& board) {
  const Eigen::Matrix2d px_per_m = image_scale_px_per_m(found, board);
  const double gap_px = 0.5 * (board.square_m - board.markers->side_m) *
                        Eigen::JacobiSVD<Eigen::Matrix2d>(px_per_m).singularValues()[1];
  return std::clamp(static_cast<int>(gap_px), min_radius_px, max_radius_px);
}

/// Inner corners in a row of the board that the markers show; nullopt if they show too few.
std::optional<int> columns_shown(const DecodedMarkers& markers, const CalibrationTarget& asked) {
  if (markers.ids.size() < min_markers_of_other) return {};
  CalibrationTarget any_height = asked;
  any_height.rows = max_squares;
  const auto [layout, found] = best_layout(markers, any_height, min_squares, max_squares);
  if (!agrees(found) || found.corners.ids.size() < min_corners_of_other) return {};
  return layout.squares_in_row - 1;
}

std::optional<OtherTarget> find_other_dictionary(const GreyImage& image,
                                                 const CalibrationTarget& asked) {
  for (const char* dictionary : common_dictionaries)
    if (columns_shown(decode_markers(image, dictionary, border_bits), asked))
      return OtherTarget{
          fmt::format("no markers of {} but of {}", asked.markers->dictionary, dictionary),
          fmt::format("give --markers {}", dictionary)};
  return {};
}

/// Side of a marker over that of a square: the mean of the ratios at which the markers form a
/// board.
std::optional<OtherTarget> find_other_marker_size(const DecodedMarkers& markers,
                                                  const CalibrationTarget& asked) {
  CalibrationTarget other = asked;
  double sum = 0.0;
  int count = 0;
  for (double ratio = min_ratio; ratio < max_ratio; ratio += ratio_step) {
    other.markers->side_m = ratio * asked.square_m;
    if (columns_shown(markers, other)) sum += ratio, ++count;
  }
  if (count == 0) return {};
  return OtherTarget{fmt::format("markers of about {:.2f} of a square, not of {:.2f}", sum / count,
                                 asked.markers->side_m / asked.square_m),
                     "measure a square and a marker: give --square-mm and --marker-mm"};
}

std::optional<OtherTarget> find_other(const GreyImage& image, const CalibrationTarget& asked) {
  const DecodedMarkers markers = decode_markers(image, asked.markers->dictionary, border_bits);
  const auto columns = columns_shown(markers, asked);
  if (!columns) {
    const auto other = find_other_marker_size(markers, asked);
    return other ? other : find_other_dictionary(image, asked);
  }
  if (*columns == asked.columns) return {};
  return OtherTarget{fmt::format("no ChArUco board with {} inner corners in a row but one with {}",
                                 asked.columns, *columns),
                     fmt::format("give --columns {}; --rows counts inner corners, too", *columns)};
}

std::optional<OtherTarget> recognize(const GreyImage& image) {
  CalibrationTarget board;
  for (const char* dictionary : common_dictionaries) {
    const DecodedMarkers markers = decode_markers(image, dictionary, border_bits);
    for (double ratio = min_ratio; ratio < max_ratio; ratio += ratio_step) {
      board.markers = {dictionary, ratio * board.square_m};
      if (const auto columns = columns_shown(markers, board))
        return OtherTarget{
            fmt::format("a ChArUco board with markers of {} and {} inner corners in a row",
                        dictionary, *columns),
            fmt::format("give --target charuco --markers {} --columns {}, and the number of --rows",
                        dictionary, *columns)};
    }
  }
  return {};
}

/// Returns the visible corners of a ChArUco board (Garrido-Jurado et al., Pattern Recognition
/// 2014) and their board indices. Both are empty below 8 corners, or if these do not span two rows
/// and two columns. Board layout: cv::aruco::CharucoBoard, with a black square in the upper left
/// corner, or a white one (cv::aruco::CharucoBoard::setLegacyPattern); the markers tell which.
///
/// A corner is used if both markers that touch it are decoded, and refined as a saddle point. On
/// boards drawn into 640x480 pixels their error is 0.02 to
/// 0.03 px; that of interpolateCornersCharuco is 0.11 to 0.16 px.
///
/// Throws usage_error for an unknown dictionary, one with fewer markers than the board needs, or a
/// marker that is not smaller than a square.
TargetCorners find_charuco_corners(const GreyImage& image, const CalibrationTarget& board) {
  validate(board);
  const DecodedMarkers markers = decode_markers(image, board.markers->dictionary, border_bits);
  const int squares_in_row = board.columns + 1;
  const auto [layout, found_roughly] = best_layout(markers, board, squares_in_row, squares_in_row);
  const TargetCorners& rough = found_roughly.corners;
  if (!agrees(found_roughly) || !can_determine_pose(rough.ids, board)) return {};
  const int radius_px = marker_free_radius_px(rough, board);
  TargetCorners found;
  for (std::size_t i = 0; i < rough.ids.size(); ++i)
    if (const auto corner = refine_saddle_point(image, rough.corners_px[i], radius_px)) {
      found.corners_px.push_back(*corner);
      found.ids.push_back(rough.ids[i]);
    }
  return can_determine_pose(found.ids, board) ? found : TargetCorners{};
}

}  // namespace

const TargetKind charuco_kind{
    .name = "charuco",
    .element = "inner corners",
    .element_corners = 1,
    .dictionary = any_dictionary,
    .place_m = square_lattice_m,
    .is_symmetric = [](const CalibrationTarget&) { return false; },
    .find_corners = find_charuco_corners,
    .find_other = find_other,
    .recognize = recognize,
};

}  // namespace touchtrace
