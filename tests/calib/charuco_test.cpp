#include "calib/board/charuco.h"

#include <gtest/gtest.h>

#include <opencv2/aruco/charuco.hpp>

#include "calib/board/board_detector.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::BoardPrint, testing::corner_rms_px, testing::print_px_per_m;

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

GreyImage render(const CalibrationTarget& board, const Eigen::Isometry3d& pose) {
  return testing::render(draw_board(board), pose);
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
  const CalibrationTarget board = charuco();
  const auto pose = board_pose(charuco(), placed.angle_axis, placed.centre_m);
  const auto [corners, ids] = find_charuco_corners(render(board, pose), board);
  EXPECT_GE(corners.size(), placed.min_corners);
  EXPECT_LE(corners.size(), placed.max_corners);
  EXPECT_LT(corner_rms_px(board, pose, corners, ids), placed.max_rms_px);
}

INSTANTIATE_TEST_SUITE_P(
    Charuco, PlacedBoard,
    ::testing::Values(Placement{"Near", {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}, 40, 40, 0.03},
                      Placement{"Far", {0.2, 0.3, -0.1}, {0.0, 0.0, 0.8}, 40, 40, 0.05},
                      Placement{"InPart", {0.2, 0.3, -0.1}, {0.21, 0.12, 0.5}, 8, 39, 0.03}),
    [](const auto& placed) { return placed.param.name; });

TEST(Charuco, CalibratesFromPartialViews) {
  BoardDetector detector(charuco());
  for (int i = 0; i < 12; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(charuco(), testing::calibration_pose(charuco(), i, 0.16, 0.4 + 0.02 * i)));
  const BoardObservations observed = std::move(detector).finish();
  ASSERT_GE(observed.views.size(), 10u);
  EXPECT_TRUE(std::ranges::any_of(
      observed.views, [](const BoardView& view) { return view.corners_px.size() < 40; }));
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.04);
  testing::expect_rendered_camera(found.color);
}

TEST(Charuco, SaysThatMarkersHaveAnotherSize) {
  CalibrationTarget other = charuco();
  other.markers->side_m = 0.012;
  const GreyImage image =
      render(charuco(), board_pose(charuco(), {0.1, 0.1, 0.0}, {0.0, 0.0, 0.5}));
  ASSERT_TRUE(find_charuco_corners(image, other).corners_px.empty());
  const auto seen = charuco_kind.find_other(image, other);
  ASSERT_TRUE(seen);
  EXPECT_NE(seen->seen.find("about 0.7"), std::string::npos) << seen->seen;  // 22 of 30 mm
  EXPECT_NE(seen->hint.find("--marker-mm"), std::string::npos);
}

TEST(Charuco, FindsNothingWithoutABoard) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  EXPECT_TRUE(find_charuco_corners(plain, charuco()).corners_px.empty());
  CalibrationTarget other = charuco();
  other.markers->dictionary = "7x7_50";
  const auto pose = board_pose(charuco(), {0.1, 0.1, 0.0}, {0.0, 0.0, 0.5});
  EXPECT_TRUE(find_charuco_corners(render(charuco(), pose), other).corners_px.empty());
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
  const auto pose = board_pose(charuco(), {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5});
  const auto [corners, ids] =
      find_charuco_corners(testing::render(draw_older_board(charuco()), pose), charuco());
  EXPECT_EQ(corners.size(), 40u);
  EXPECT_LT(corner_rms_px(charuco(), pose, corners, ids), 0.03);
}

TEST(Charuco, TellsHowManyCornersARowHas) {
  const auto image = render(charuco(), board_pose(charuco(), {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}));
  EXPECT_FALSE(charuco_kind.find_other(image, charuco()));
  for (const int columns : {6, 7, 9}) {
    CalibrationTarget asked = charuco();
    asked.columns = columns;
    EXPECT_TRUE(find_charuco_corners(image, asked).corners_px.empty()) << columns;
    const auto other = charuco_kind.find_other(image, asked);
    ASSERT_TRUE(other) << columns;
    EXPECT_NE(other->seen.find("but one with 8"), std::string::npos) << other->seen;
  }
}

TEST(Charuco, TellsTheDictionary) {
  const auto image = render(charuco(), board_pose(charuco(), {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}));
  CalibrationTarget asked = charuco();
  asked.markers->dictionary = "6x6_50";
  const auto other = charuco_kind.find_other(image, asked);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->hint, "give --markers 5x5_1000");
}

TEST(Charuco, IsRecognizedWhereAnotherKindWasAskedFor) {
  const auto image = render(charuco(), board_pose(charuco(), {0.4, -0.3, 0.2}, {0.02, 0.01, 0.5}));
  for (const TargetKind* kind : target_kinds()) {
    if (kind == &charuco_kind) continue;
    const auto other = recognize_target(image, *kind);
    ASSERT_TRUE(other) << kind->name;
    EXPECT_EQ(other->seen, "a ChArUco board with markers of 5x5_1000 and 8 inner corners in a row");
  }
}

TEST(Charuco, RejectsImpossibleBoards) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  CalibrationTarget board = charuco();
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
