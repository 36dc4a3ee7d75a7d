#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>

#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::Placement;

/// 5x4 markers of 30 mm with a gap of 25 %.
CalibrationTarget aruco_grid() {
  return {10, 8, 0.0375, CalibrationTarget::Markers{"5x5_100", 0.03}, &aruco_grid_kind};
}

/// `is_turned`: each marker by half a turn, as AprilTag prints its tags.
testing::BoardPrint draw(const CalibrationTarget& grid, bool is_turned = false) {
  const auto px = [](double m) { return int(std::lround(m * testing::print_px_per_m)); };
  const int pitch = px(grid.square_m), side = px(grid.markers->side_m), gap = pitch - side;
  const int columns = grid.columns / 2, rows = grid.rows / 2;
  cv::Mat drawing(rows * pitch + gap, columns * pitch + gap, CV_8U, cv::Scalar(255));
  for (int id = 0; id < columns * rows; ++id) {
    cv::Mat marker;
    cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100)->drawMarker(id, side, marker);
    if (is_turned) cv::rotate(marker, marker, cv::ROTATE_180);
    marker.copyTo(
        drawing(cv::Rect(gap + id % columns * pitch, gap + id / columns * pitch, side, side)));
  }
  return {drawing, Eigen::Vector2d::Constant(double(gap) / testing::print_px_per_m)};
}

GreyImage near_view() {
  return testing::render(draw(aruco_grid()),
                         board_pose(aruco_grid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3}));
}

CalibrationTarget with_columns(int columns) {
  CalibrationTarget grid = aruco_grid();
  grid.columns = columns;
  return grid;
}

class PlacedArucoGrid : public ::testing::TestWithParam<Placement> {};

TEST_P(PlacedArucoGrid, CornersAreAccurate) {
  testing::expect_accurate_corners(draw(aruco_grid()), aruco_grid(), GetParam(), 0.06);
}

INSTANTIATE_TEST_SUITE_P(
    ArucoGrid, PlacedArucoGrid,
    ::testing::Values(Placement{"Near", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3}, 80, 80},
                      Placement{"Far", {0.2, 0.3, 1.4}, {0.0, 0.0, 0.5}, 80, 80},
                      Placement{"InPart", {0.2, 0.3, -0.1}, {0.1, 0.06, 0.28}, 20, 76}),
    [](const auto& placed) { return placed.param.name; });

TEST(ArucoGrid, CalibratesFromPartialViews) {
  const auto observed = testing::observe(draw(aruco_grid()), aruco_grid(), 0.08, 0.27, 0.01);
  EXPECT_TRUE(testing::shows_parts(observed));
  testing::expect_calibration(observed, 0.06);
}

TEST(ArucoGrid, MarkersMayBeTurnedByHalfATurn) {
  const auto print = draw(aruco_grid(), true);
  const Placement placed{"Turned", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3}, 80, 80};
  testing::expect_accurate_corners(print, aruco_grid(), placed, 0.06);
  const auto image =
      testing::render(print, board_pose(aruco_grid(), placed.angle_axis, placed.centre_m));
  const auto seen = recognize_target(image, chessboard_kind);
  ASSERT_TRUE(seen);
  EXPECT_NE(seen->seen.find("5 in a row"), std::string::npos) << seen->seen;
  EXPECT_FALSE(aruco_grid_kind.find_other(image, aruco_grid()));
  testing::expect_other(image, with_columns(8), "no grid with 4 tags in a row but one with 5");
}

TEST(ArucoGrid, TellsHowManyTagsARowHas) {
  EXPECT_FALSE(aruco_grid_kind.find_other(near_view(), aruco_grid()));
  testing::expect_other(near_view(), with_columns(8),
                        "no grid with 4 tags in a row but one with 5");
}

TEST(ArucoGrid, IsRecognizedWhereAnotherKindWasAskedFor) {
  testing::expect_recognized(near_view(), aruco_grid_kind,
                             "a grid of 5x5_1000 markers with 5 in a row");
  EXPECT_FALSE(recognize_target(near_view(), aruco_grid_kind));
}

TEST(ArucoGrid, RejectsImpossibleTargets) {
  EXPECT_TRUE(testing::finds_nothing(testing::plain_image, aruco_grid()));
  CalibrationTarget no_gap = aruco_grid(), too_large = with_columns(22), unknown = aruco_grid();
  no_gap.markers->side_m = no_gap.square_m;
  too_large.rows = 22;
  unknown.markers->dictionary = "5x5_99";
  for (const auto& grid : {no_gap, too_large, unknown})
    EXPECT_THROW(testing::finds_nothing(testing::plain_image, grid), Error);
}

}  // namespace
}  // namespace touchtrace
