#include "calib/board/chessboard.h"

#include <opencv2/calib3d.hpp>

#include "calib/board/enlarged.h"
#include "calib/board/markers.h"

namespace touchtrace {
namespace {

constexpr int thorough =
    cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;

std::vector<Eigen::Vector2d> find_enlarged(const EnlargedImage& image, const Chessboard& board,
                                           int flags) {
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCornersSB(image.pixels, {board.columns, board.rows}, points, flags))
    return {};
  std::vector<Eigen::Vector2d> corners;
  for (const auto& p : points) corners.push_back(image.in_original(p));
  return corners;
}

}  // namespace

std::vector<Eigen::Vector2d> find_chessboard(const GreyImage& image, const Chessboard& board) {
  const int scale = usual_enlargement(image);
  // From quick to thorough; which of them fails on a view is not foreseeable.
  const std::pair<int, int> attempts[] = {
      {scale, 0}, {scale, thorough}, {1, cv::CALIB_CB_ACCURACY}, {1, thorough}};
  for (const auto& [enlarge, flags] : attempts)
    if (auto corners = find_enlarged({image, enlarge}, board, flags); !corners.empty())
      return corners;
  return {};
}

void add_view(BoardObservations& observations, std::string name, const GreyImage& image,
              std::vector<float> depth_m) {
  const Chessboard& board = observations.board;
  BoardView view;
  if (board.markers)
    std::tie(view.corners_px, view.shown) = find_marked_corners(image, board);
  else
    view.corners_px = find_chessboard(image, board);
  if (view.corners_px.empty()) {
    observations.views_without_board.push_back(std::move(name));
    return;
  }
  view.name = std::move(name), view.depth_m = std::move(depth_m);
  observations.views.push_back(std::move(view));
}

}  // namespace touchtrace
