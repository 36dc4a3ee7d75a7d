#include "calib/rgbd/initial_guess.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace touchtrace {
namespace {

std::vector<cv::Point3f> board_points(const BoardView& view, const Chessboard& board) {
  std::vector<cv::Point3f> points;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const Eigen::Vector3f corner = board.corner_m(view.corner(i)).cast<float>();
    points.emplace_back(corner.x(), corner.y(), corner.z());
  }
  return points;
}

std::vector<cv::Point2f> image_points(const BoardView& view) {
  std::vector<cv::Point2f> points;
  for (const auto& corner : view.corners_px)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  return points;
}

/// Zhang's estimate breaks down where every view is nearly parallel to the image.
double plausible_focal_length(double focal_px, int width) {
  const double typical_px = 1.0 * width;
  return std::isfinite(focal_px) && focal_px > 0.3 * width && focal_px < 10.0 * width ? focal_px
                                                                                      : typical_px;
}

cv::Matx33d initial_camera(const BoardObservations& observations) {
  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::vector<cv::Point2f>> images;
  for (const auto& view : observations.views) {
    boards.push_back(board_points(view, observations.board));
    images.push_back(image_points(view));
  }
  cv::Matx33d camera =
      cv::initCameraMatrix2D(boards, images, {observations.width, observations.height}, 1.0);
  camera(0, 0) = camera(1, 1) = plausible_focal_length(camera(0, 0), observations.width);
  return camera;
}

std::array<double, 6> initial_pose(const BoardView& view, const Chessboard& board,
                                   const cv::Matx33d& camera) {
  cv::Vec3d rotation, translation;
  cv::solvePnP(board_points(view, board), image_points(view), camera, cv::noArray(), rotation,
               translation, false, cv::SOLVEPNP_IPPE);
  return {rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2]};
}

}  // namespace

RgbdParameters initial_guess(const BoardObservations& observations) {
  const cv::Matx33d camera = initial_camera(observations);
  RgbdParameters parameters;
  parameters.color = {camera(0, 0), camera(1, 1), camera(0, 2), camera(1, 2)};
  for (const auto& view : observations.views)
    parameters.camera_from_board.push_back(initial_pose(view, observations.board, camera));
  return parameters;
}

}  // namespace touchtrace
