#include "calib/board/charuco.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

constexpr int width = 640, height = 480, print_px_per_m = 4000;
const Eigen::Matrix3d camera_matrix =
    (Eigen::Matrix3d() << 600.0, 0.0, 322.0, 0.0, 602.0, 238.0, 0.0, 0.0, 1.0).finished();

Chessboard charuco() {
  Chessboard board{8, 5, 0.03};
  board.markers = {"5x5_100", 0.022};
  return board;
}

/// Board drawn by cv::aruco without a margin.
cv::Mat draw_board(const Chessboard& board) {
  const int across = board.columns + 1, along = board.rows + 1;
  const auto charuco = cv::aruco::CharucoBoard::create(
      across, along, float(board.square_m), float(board.markers->side_m),
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  const double square_px = board.square_m * print_px_per_m;
  cv::Mat image;
  charuco->draw(cv::Size(int(across * square_px), int(along * square_px)), image);
  return image;
}

/// camera_from_board with the board's centre at `centre_m`.
Eigen::Isometry3d board_pose(const Eigen::Vector3d& angle_axis, const Eigen::Vector3d& centre_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_axis.norm(), angle_axis.normalized()).toRotationMatrix();
  pose.translation() = centre_m - pose.linear() * Eigen::Vector3d(0.105, 0.06, 0.0);
  return pose;
}

Eigen::Matrix3d image_from_board(const Eigen::Isometry3d& pose) {
  Eigen::Matrix3d plane;
  plane << pose.linear().leftCols<2>(), pose.translation();
  return camera_matrix * plane;
}

/// Image of the board before grey, with antialiasing and noise of 1 grey level. The drawing begins
/// a square before corner 0.
GreyImage render(const Chessboard& board, const Eigen::Isometry3d& pose) {
  Eigen::Matrix3d board_from_print = Eigen::Matrix3d::Identity() / print_px_per_m;
  board_from_print(2, 2) = 1.0;
  board_from_print.col(2).head<2>().setConstant(0.5 / print_px_per_m - board.square_m);
  const Eigen::Matrix3d h = image_from_board(pose) * board_from_print;
  constexpr int finer = 4;
  cv::Matx33d finer_h(finer * h(0, 0), finer * h(0, 1), finer * h(0, 2), finer * h(1, 0),
                      finer * h(1, 1), finer * h(1, 2), h(2, 0), h(2, 1), h(2, 2));
  const double shift = 0.5 * (finer - 1);
  for (int i = 0; i < 3; ++i) {
    finer_h(0, i) += shift * finer_h(2, i);
    finer_h(1, i) += shift * finer_h(2, i);
  }
  cv::Mat fine, image;
  cv::warpPerspective(draw_board(board), fine, finer_h, {finer * width, finer * height},
                      cv::INTER_LINEAR, cv::BORDER_CONSTANT, 170);
  cv::resize(fine, image, {width, height}, 0, 0, cv::INTER_AREA);
  RandomStream random(1, "photograph");
  GreyImage grey{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    grey.pixels.push_back(cv::saturate_cast<std::uint8_t>(image.data[i] + random.normal()));
  return grey;
}

Eigen::Vector2d project(const Chessboard& board, const Eigen::Isometry3d& pose, int corner) {
  return (camera_matrix * (pose * board.corner_m(corner))).hnormalized();
}

double rms_px(const Chessboard& board, const Eigen::Isometry3d& pose,
              const std::vector<Eigen::Vector2d>& corners, const std::vector<int>& ids) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sum += (corners[i] - project(board, pose, ids[i])).squaredNorm();
  return std::sqrt(sum / static_cast<double>(corners.size()));
}

struct Placement {
  const char* name;
  Eigen::Vector3d angle_axis, centre_m;
  std::size_t min_corners, max_corners;
  double max_rms_px;
};

class PlacedBoard : public ::testing::TestWithParam<Placement> {};

TEST_P(PlacedBoard, CornersAreAccurate) {
  const Placement& placed = GetParam();
  const Chessboard board = charuco();
  const auto pose = board_pose(placed.angle_axis, placed.centre_m);
  const auto [corners, ids] = find_charuco_corners(render(board, pose), board);
  EXPECT_GE(corners.size(), placed.min_corners);
  EXPECT_LE(corners.size(), placed.max_corners);
  EXPECT_LT(rms_px(board, pose, corners, ids), placed.max_rms_px);
}

INSTANTIATE_TEST_SUITE_P(
    Charuco, PlacedBoard,
    ::testing::Values(Placement{"Near", {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}, 40, 40, 0.03},
                      Placement{"Far", {0.2, 0.3, -0.1}, {0.0, 0.0, 0.8}, 40, 40, 0.05},
                      Placement{"InPart", {0.2, 0.3, -0.1}, {0.21, 0.12, 0.5}, 8, 39, 0.03}),
    [](const auto& placed) { return placed.param.name; });

TEST(Charuco, CalibratesFromPartialViews) {
  BoardObservations observed;
  observed.board = charuco();
  observed.width = width, observed.height = height;
  const double sides[] = {-0.16, 0.0, 0.16};
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d turn(0.5 * ((i % 3) - 1) + 0.1, 0.5 * ((i / 3) % 2 ? 1 : -1), 0.1 * i);
    const Eigen::Vector3d place(sides[i % 3], sides[(i / 4) % 3] * 0.7, 0.4 + 0.02 * i);
    add_view(observed, "view " + std::to_string(i),
             render(observed.board, board_pose(turn, place)));
  }
  ASSERT_GE(observed.views.size(), 10u);
  EXPECT_TRUE(std::ranges::any_of(
      observed.views, [](const BoardView& view) { return view.corners_px.size() < 40; }));
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.04);
  EXPECT_NEAR(found.color.fx, 600.0, 0.5);
  EXPECT_NEAR(found.color.fy, 602.0, 0.5);
  EXPECT_NEAR(found.color.cx, 322.0, 0.5);
  EXPECT_NEAR(found.color.cy, 238.0, 0.5);
}

TEST(Charuco, FindsNothingWithoutABoard) {
  const GreyImage plain{width, height, std::vector<std::uint8_t>(width * height, 128)};
  EXPECT_TRUE(find_charuco_corners(plain, charuco()).first.empty());
  Chessboard other = charuco();
  other.markers->dictionary = "7x7_50";
  const auto pose = board_pose({0.1, 0.1, 0.0}, {0.0, 0.0, 0.5});
  EXPECT_TRUE(find_charuco_corners(render(charuco(), pose), other).first.empty());
}

TEST(Charuco, RejectsImpossibleBoards) {
  const GreyImage plain{width, height, std::vector<std::uint8_t>(width * height, 128)};
  Chessboard board = charuco();
  board.markers->dictionary = "5x5_99";
  EXPECT_THROW(find_charuco_corners(plain, board), Error);
  board.markers = {"5x5_100", 0.03};
  EXPECT_THROW(find_charuco_corners(plain, board), Error);
  board.markers = {"4x4_50", 0.02};
  board.columns = 20;
  EXPECT_THROW(find_charuco_corners(plain, board), Error);
}

}  // namespace
}  // namespace touchtrace
