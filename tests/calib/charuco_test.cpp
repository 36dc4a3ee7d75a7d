#include <gtest/gtest.h>

#include <opencv2/aruco/charuco.hpp>

#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::BoardPrint, testing::Placement, testing::print_px_per_m;

CalibrationTarget charuco() {
  CalibrationTarget board{8, 5, 0.03};
  board.markers = {"5x5_100", 0.022};
  board.kind = &charuco_kind;
  return board;
}

/// Board drawn by cv::aruco without a margin.
BoardPrint draw_board(const CalibrationTarget& board) {
  const int across = board.columns + 1, along = board.rows + 1;
  const auto charuco = cv::aruco::CharucoBoard::create(
      across, along, float(board.square_m), float(board.markers->side_m),
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  const double square_px = board.square_m * print_px_per_m;
  BoardPrint print{{}, Eigen::Vector2d::Constant(board.square_m)};
  charuco->draw(cv::Size(int(across * square_px), int(along * square_px)), print.pixels);
  return print;
}

GreyImage view_of(const Eigen::Vector3d& angle_axis, const Eigen::Vector3d& centre_m) {
  return testing::render(draw_board(charuco()), board_pose(charuco(), angle_axis, centre_m));
}

GreyImage near_view() { return view_of({0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}); }

class PlacedBoard : public ::testing::TestWithParam<std::pair<Placement, double>> {};

TEST_P(PlacedBoard, CornersAreAccurate) {
  const auto& [placed, max_rms_px] = GetParam();
  testing::expect_accurate_corners(draw_board(charuco()), charuco(), placed, max_rms_px);
}

INSTANTIATE_TEST_SUITE_P(
    Charuco, PlacedBoard,
    ::testing::Values(
        std::pair(Placement{"Near", {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}, 40, 40}, 0.03),
        std::pair(Placement{"Far", {0.2, 0.3, -0.1}, {0.0, 0.0, 0.8}, 40, 40}, 0.05),
        std::pair(Placement{"InPart", {0.2, 0.3, -0.1}, {0.21, 0.12, 0.5}, 8, 39}, 0.03)),
    [](const auto& row) { return row.param.first.name; });

TEST(Charuco, CalibratesFromPartialViews) {
  const auto observed = testing::observe(draw_board(charuco()), charuco(), 0.16, 0.4, 0.02);
  EXPECT_TRUE(testing::shows_parts(observed));
  testing::expect_calibration(observed, 0.04);
}

TEST(Charuco, SaysThatMarkersHaveAnotherSize) {
  CalibrationTarget asked = charuco();
  asked.markers->side_m = 0.012;
  const GreyImage image = view_of({0.1, 0.1, 0.0}, {0.0, 0.0, 0.5});
  testing::expect_other(image, asked, "about 0.7");  // 22 of 30 mm
  EXPECT_NE(charuco_kind.find_other(image, asked)->hint.find("--marker-mm"), std::string::npos);
}

TEST(Charuco, FindsNothingWithoutABoard) {
  EXPECT_TRUE(testing::finds_nothing(testing::plain_image, charuco()));
  CalibrationTarget other = charuco();
  other.markers->dictionary = "7x7_50";
  EXPECT_TRUE(testing::finds_nothing(view_of({0.1, 0.1, 0.0}, {0.0, 0.0, 0.5}), other));
}

/// Board as OpenCV before 4.6 drew it: a marker in the upper left corner.
BoardPrint draw_older_board(const CalibrationTarget& board) {
  const int square_px = int(board.square_m * print_px_per_m),
            side_px = int(board.markers->side_m * print_px_per_m);
  BoardPrint print{
      cv::Mat((board.rows + 1) * square_px, (board.columns + 1) * square_px, CV_8U, cv::Scalar(0)),
      Eigen::Vector2d::Constant(board.square_m)};
  for (int y = 0, id = 0; y <= board.rows; ++y)
    for (int x = y % 2; x <= board.columns; x += 2, ++id) {
      cv::Mat square = print.pixels(cv::Rect(x * square_px, y * square_px, square_px, square_px));
      square = 255;
      cv::Mat marker;
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100)->drawMarker(id, side_px, marker);
      const int gap = (square_px - side_px) / 2;
      marker.copyTo(square(cv::Rect(gap, gap, side_px, side_px)));
    }
  return print;
}

TEST(Charuco, FindsBoardsWithAMarkerInTheFirstSquare) {
  testing::expect_accurate_corners(draw_older_board(charuco()), charuco(),
                                   {"Older", {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}, 40, 40}, 0.03);
}

TEST(Charuco, TellsHowManyCornersARowHas) {
  EXPECT_FALSE(charuco_kind.find_other(near_view(), charuco()));
  for (const int columns : {6, 7, 9}) {
    CalibrationTarget asked = charuco();
    asked.columns = columns;
    testing::expect_other(near_view(), asked, "but one with 8");
  }
}

TEST(Charuco, TellsTheDictionary) {
  CalibrationTarget asked = charuco();
  asked.markers->dictionary = "6x6_50";
  const auto other = charuco_kind.find_other(near_view(), asked);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->hint, "give --markers 5x5_1000");
}

TEST(Charuco, IsRecognizedWhereAnotherKindWasAskedFor) {
  testing::expect_recognized(
      near_view(), charuco_kind,
      "a ChArUco board with markers of 5x5_1000 and 8 inner corners in a row");
}

TEST(Charuco, RejectsImpossibleBoards) {
  CalibrationTarget unknown = charuco(), no_gap = charuco(), too_large = charuco();
  unknown.markers->dictionary = "5x5_99";
  no_gap.markers = {"5x5_100", 0.03};
  too_large.markers = {"4x4_50", 0.02};
  too_large.columns = 20;
  for (const auto& board : {unknown, no_gap, too_large})
    EXPECT_THROW(testing::finds_nothing(testing::plain_image, board), Error);
}

}  // namespace
}  // namespace touchtrace
