#include "calib/board/markers.h"

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

/// The board as cv::aruco prints it, without a margin.
cv::Mat printed(const Chessboard& board) {
  const int across = board.columns + 1, along = board.rows + 1;
  const auto charuco = cv::aruco::CharucoBoard::create(
      across, along, float(board.square_m), float(board.markers->side_m),
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  const double square_px = board.square_m * print_px_per_m;
  cv::Mat image;
  charuco->draw(cv::Size(int(across * square_px), int(along * square_px)), image);
  return image;
}

/// In the board's frame, z away from the camera: the corner of the print is a square up and left.
Eigen::Isometry3d pose_of(const Eigen::Vector3d& turn, const Eigen::Vector3d& place_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  pose.translation() = place_m - pose.linear() * Eigen::Vector3d(0.105, 0.06, 0.0);
  return pose;
}

Eigen::Matrix3d image_from_board(const Eigen::Isometry3d& pose) {
  Eigen::Matrix3d plane;
  plane << pose.linear().leftCols<2>(), pose.translation();
  return camera_matrix * plane;
}

/// Grey paper behind the print, a little blur and noise.
GreyImage photographed(const Chessboard& board, const Eigen::Isometry3d& pose) {
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
  cv::warpPerspective(printed(board), fine, finer_h, {finer * width, finer * height},
                      cv::INTER_LINEAR, cv::BORDER_CONSTANT, 170);
  cv::resize(fine, image, {width, height}, 0, 0, cv::INTER_AREA);
  RandomStream random(1, "photograph");
  GreyImage grey{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    grey.pixels.push_back(cv::saturate_cast<std::uint8_t>(image.data[i] + random.normal()));
  return grey;
}

Eigen::Vector2d projected(const Chessboard& board, const Eigen::Isometry3d& pose, int corner) {
  return (camera_matrix * (pose * board.corner_m(corner))).hnormalized();
}

double rms_px(const Chessboard& board, const Eigen::Isometry3d& pose,
              const std::vector<Eigen::Vector2d>& corners, const std::vector<int>& shown) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sum += (corners[i] - projected(board, pose, shown[i])).squaredNorm();
  return std::sqrt(sum / static_cast<double>(corners.size()));
}

struct Placed {
  const char* name;
  Eigen::Vector3d turn, place_m;
  std::size_t least, most;  ///< corners
  double most_rms_px;
};

class PlacedBoard : public ::testing::TestWithParam<Placed> {};

TEST_P(PlacedBoard, CornersAreFoundWhereTheyAre) {
  const Placed& placed = GetParam();
  const Chessboard board = charuco();
  const auto pose = pose_of(placed.turn, placed.place_m);
  const auto [corners, shown] = find_marked_corners(photographed(board, pose), board);
  EXPECT_GE(corners.size(), placed.least);
  EXPECT_LE(corners.size(), placed.most);
  EXPECT_LT(rms_px(board, pose, corners, shown), placed.most_rms_px);
}

INSTANTIATE_TEST_SUITE_P(
    MarkedBoard, PlacedBoard,
    ::testing::Values(Placed{"Near", {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}, 40, 40, 0.03},
                      Placed{"Far", {0.2, 0.3, -0.1}, {0.0, 0.0, 0.8}, 40, 40, 0.05},
                      Placed{"InPart", {0.2, 0.3, -0.1}, {0.21, 0.12, 0.5}, 8, 39, 0.03}),
    [](const auto& placed) { return placed.param.name; });

TEST(MarkedBoard, CalibratesFromPartialViews) {
  BoardObservations observed;
  observed.board = charuco();
  observed.width = width, observed.height = height;
  const double sides[] = {-0.16, 0.0, 0.16};
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d turn(0.5 * ((i % 3) - 1) + 0.1, 0.5 * ((i / 3) % 2 ? 1 : -1), 0.1 * i);
    const Eigen::Vector3d place(sides[i % 3], sides[(i / 4) % 3] * 0.7, 0.4 + 0.02 * i);
    add_view(observed, "view " + std::to_string(i),
             photographed(observed.board, pose_of(turn, place)));
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

TEST(MarkedBoard, NothingIsFoundWhereThereIsNone) {
  const GreyImage plain{width, height, std::vector<std::uint8_t>(width * height, 128)};
  EXPECT_TRUE(find_marked_corners(plain, charuco()).first.empty());
  Chessboard other = charuco();
  other.markers->dictionary = "7x7_50";
  const auto pose = pose_of({0.1, 0.1, 0.0}, {0.0, 0.0, 0.5});
  EXPECT_TRUE(find_marked_corners(photographed(charuco(), pose), other).first.empty());
}

TEST(MarkedBoard, ImpossibleBoardsAreRefused) {
  const GreyImage plain{width, height, std::vector<std::uint8_t>(width * height, 128)};
  Chessboard board = charuco();
  board.markers->dictionary = "5x5_99";
  EXPECT_THROW(find_marked_corners(plain, board), Error);
  board.markers = {"5x5_100", 0.03};
  EXPECT_THROW(find_marked_corners(plain, board), Error);
  board.markers = {"4x4_50", 0.02};
  board.columns = 20;
  EXPECT_THROW(find_marked_corners(plain, board), Error);
}

}  // namespace
}  // namespace touchtrace
