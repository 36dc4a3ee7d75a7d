#include "calib/board/chessboard.h"

#include <opencv2/calib3d.hpp>

#include "calib/board/charuco.h"
#include "calib/board/upscaled_image.h"

namespace touchtrace {
namespace {

constexpr int exhaustive =
    cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;

std::vector<Eigen::Vector2d> find_in_upscaled(const UpscaledImage& image, const Chessboard& board,
                                              int flags) {
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCornersSB(image.pixels, {board.columns, board.rows}, points, flags))
    return {};
  std::vector<Eigen::Vector2d> corners;
  for (const auto& p : points) corners.push_back(image.to_original(p));
  return corners;
}

}  // namespace

std::vector<Eigen::Vector2d> find_chessboard(const GreyImage& image, const Chessboard& board) {
  const int scale = default_upscale_factor(image);
  // Fastest first. No setting detects every board.
  const std::pair<int, int> attempts[] = {
      {scale, 0}, {scale, exhaustive}, {1, cv::CALIB_CB_ACCURACY}, {1, exhaustive}};
  for (const auto& [factor, flags] : attempts)
    if (auto corners = find_in_upscaled({image, factor}, board, flags); !corners.empty())
      return corners;
  return {};
}

void add_view(BoardObservations& observations, std::string name, const GreyImage& image,
              std::vector<float> depth_m) {
  const Chessboard& board = observations.board;
  BoardView view;
  if (board.markers)
    std::tie(view.corners_px, view.corner_ids) = find_charuco_corners(image, board);
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
