#include "calib/board/board_detector.h"

#include <fmt/core.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "calib/board/chessboard.h"
#include "calib/board/image_matrix.h"
#include "calib/board/view_order.h"

namespace touchtrace {
namespace {

/// Mean grey value where an image shows nothing; 9 to 15 outside of the image circle of a public
/// fisheye in a lit room, 17 to 28 at its edge.
constexpr double max_black = 16.0;
constexpr int pixels_around = 8;  ///< half-width of the averaging window

/// Mean grey value of the square around a pixel of ImageGrid, within the image.
double mean_grey(const cv::Mat& image, int column, int row) {
  const Eigen::Vector2d centre = ImageGrid::pixel(image.cols, image.rows, column, row);
  const cv::Rect around(static_cast<int>(centre.x()) - pixels_around,
                        static_cast<int>(centre.y()) - pixels_around, 2 * pixels_around + 1,
                        2 * pixels_around + 1);
  return cv::mean(image(around & cv::Rect({}, image.size())))[0];
}

/// Corners along the rows of the board, if the part is all of it; else empty. Several orders fit a
/// symmetric board; one of them is taken.
std::vector<Eigen::Vector2d> corners_of_whole_board(const ChessboardPart& part,
                                                    const CalibrationTarget& board,
                                                    std::optional<bool> is_main_dark) {
  const auto places = possible_places(part, board, is_main_dark);
  if (static_cast<int>(part.cells.size()) < board.num_corners() || places.empty()) return {};
  std::vector<Eigen::Vector2d> corners(part.corners_px.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[static_cast<std::size_t>(places.front()[i])] = part.corners_px[i];
  return corners;
}

}  // namespace

BoardDetector::BoardDetector(const CalibrationTarget& board) {
  observations_.board = board;
  observations_.lit.setConstant(false);
}

void BoardDetector::update_lit(const GreyImage& image) {
  const cv::Mat pixels = as_matrix(image);
  for (int row = 0; row < ImageGrid::rows; ++row)
    for (int column = 0; column < ImageGrid::columns; ++column)
      observations_.lit(row, column) |= mean_grey(pixels, column, row) > max_black;
}

BoardFound BoardDetector::add(BoardView view, const GreyImage& image) {
  const CalibrationTarget& board = observations_.board;
  observations_.width = image.width, observations_.height = image.height;
  update_lit(image);
  auto [corners_px, ids] = board.kind->find_corners(image, board);
  view.corners_px = std::move(corners_px), view.corner_ids = std::move(ids);
  if (view.corners_px.empty()) return add_part(std::move(view), image);
  if (board.kind == &chessboard_kind && !view.corner_ids.empty()) complete(view, image);
  return add_whole(std::move(view), image);
}

void BoardDetector::complete(BoardView& view, const GreyImage& image) const {
  const auto part = find_chessboard_part(image);
  if (!part) return;
  auto all = corners_of_whole_board(*part, observations_.board, is_main_dark_);
  if (!all.empty()) view.corners_px = std::move(all), view.corner_ids.clear();
}

BoardFound BoardDetector::add_whole(BoardView view, const GreyImage& image) {
  const CalibrationTarget& board = observations_.board;
  if (board.kind == &chessboard_kind && view.corner_ids.empty()) {
    view.relative_edge_width = relative_edge_width(image, view.corners_px, board);
    if (!is_main_dark_) is_main_dark_ = is_corner_0_main_dark(image, board, view.corners_px);
  }
  observations_.views.push_back(std::move(view));
  return BoardFound::whole;
}

BoardFound BoardDetector::add_part(BoardView view, const GreyImage& image) {
  const CalibrationTarget& board = observations_.board;
  const auto part = board.kind == &chessboard_kind ? find_chessboard_part(image)
                                                   : std::optional<ChessboardPart>();
  if (!part || possible_places(*part, board, {}).empty()) {
    observations_.views_without_board.push_back(std::move(view.name));
    return BoardFound::nothing;
  }
  view.corners_px = corners_of_whole_board(*part, board, is_main_dark_);
  if (!view.corners_px.empty()) return add_whole(std::move(view), image);
  partial_views_.push_back({std::move(view), *part});
  return BoardFound::part;
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
