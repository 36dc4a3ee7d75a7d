#include "calib/board/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace touchtrace {
namespace {

constexpr double wanted_size_px = 1280.0;
constexpr int max_enlargement = 4;
constexpr int thorough =
    cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;

int enlargement(const GreyImage& image) {
  const double size_px = std::max(image.width, image.height);
  return std::clamp(static_cast<int>(std::lround(wanted_size_px / size_px)), 1, max_enlargement);
}

/// Corners in pixels of `image`, looked for in the image enlarged `scale` times. Pixel centres are
/// integers in both, hence the halves.
std::vector<Eigen::Vector2d> find_enlarged(const cv::Mat& image, const Chessboard& board, int scale,
                                           int flags) {
  cv::Mat enlarged;
  cv::resize(image, enlarged, cv::Size(), scale, scale, cv::INTER_CUBIC);
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCornersSB(enlarged, {board.columns, board.rows}, points, flags)) return {};
  std::vector<Eigen::Vector2d> corners;
  for (const auto& p : points)
    corners.emplace_back((p.x + 0.5) / scale - 0.5, (p.y + 0.5) / scale - 0.5);
  return corners;
}

}  // namespace

std::vector<Eigen::Vector2d> find_chessboard(const GreyImage& image, const Chessboard& board) {
  const cv::Mat pixels(image.height, image.width, CV_8U,
                       const_cast<std::uint8_t*>(image.pixels.data()));
  const int scale = enlargement(image);
  // From quick to thorough; which of them fails on a view is not foreseeable.
  const std::pair<int, int> attempts[] = {
      {scale, 0}, {scale, thorough}, {1, cv::CALIB_CB_ACCURACY}, {1, thorough}};
  for (const auto& [enlarge, flags] : attempts)
    if (auto corners = find_enlarged(pixels, board, enlarge, flags); !corners.empty())
      return corners;
  return {};
}

void add_view(BoardObservations& observations, std::string name, const GreyImage& image,
              std::vector<float> depth_m) {
  auto corners = find_chessboard(image, observations.board);
  if (corners.empty())
    observations.views_without_board.push_back(std::move(name));
  else
    observations.views.push_back({std::move(name), std::move(corners), std::move(depth_m)});
}

}  // namespace touchtrace
