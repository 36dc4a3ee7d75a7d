#include "pipeline/scene/camera/board_views.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "pipeline/scene/camera/backdrop.h"
#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {
namespace {

/// Error of each detected corner with respect to the nearest true corner.
std::vector<Eigen::Vector2d> corner_errors_px(const std::vector<cv::Point2f>& found,
                                              const RgbdCamera& camera, const BoardInfo& board,
                                              const Eigen::Isometry3d& color_from_board) {
  std::vector<Eigen::Vector2d> errors;
  for (const auto& corner : found) {
    Eigen::Vector2d nearest = Eigen::Vector2d::Constant(1e9);
    for (int row = 0; row < board.rows; ++row)
      for (int column = 0; column < board.columns; ++column) {
        const Eigen::Vector3d point(board.square_m * (column - 0.5 * (board.columns - 1)),
                                    board.square_m * (row - 0.5 * (board.rows - 1)), 0.0);
        const Eigen::Vector2d truth = camera.color.project(color_from_board * point);
        const Eigen::Vector2d error = Eigen::Vector2d(corner.x, corner.y) - truth;
        if (error.norm() < nearest.norm()) nearest = error;
      }
    errors.push_back(nearest);
  }
  return errors;
}

class BoardViews : public ::testing::TestWithParam<int> {};

TEST_P(BoardViews, DetectedCornersMatchTheTruth) {
  SceneOptions options;
  options.image_width = GetParam(), options.image_height = GetParam() * 3 / 4;
  const RgbdCamera camera = make_camera(options);
  const BoardInfo board;
  const auto poses = board_poses(camera, board, options.board_views, options.seed);
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(options.board_views));
  Runtime runtime(choose_device(""));
  Renderer renderer(runtime, camera, options.seed);
  int found_views = 0;
  std::vector<Eigen::Vector2d> errors_px;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto solids = room_solids();
    solids.push_back(board_solid(board, camera.color_from_world.inverse() * poses[i]));
    RgbdFrame frame = renderer.render(static_exposure(solids), "board", i, 4);
    const cv::Mat image(options.image_height, options.image_width, CV_8UC3, frame.color.data());
    std::vector<cv::Point2f> corners;
    if (!cv::findChessboardCornersSB(image, {board.columns, board.rows}, corners,
                                     cv::CALIB_CB_ACCURACY))
      continue;
    ++found_views;
    const auto errors = corner_errors_px(corners, camera, board, poses[i]);
    errors_px.insert(errors_px.end(), errors.begin(), errors.end());
  }
  EXPECT_GE(found_views, 18) << "of " << poses.size();
  // Errors of the detector: 0.02 px for large squares, up to 0.2 px for tilted squares of 8 px. A
  // wrong pixel convention or distortion of the renderer gives half a pixel or more.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (const auto& error : errors_px) sum += error, squares += error.squaredNorm();
  EXPECT_LT(sum.norm() / static_cast<double>(errors_px.size()), 0.05);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(errors_px.size())), 0.2);
}

INSTANTIATE_TEST_SUITE_P(ImageWidths, BoardViews, ::testing::Values(320, 640));

}  // namespace
}  // namespace touchtrace::scene
