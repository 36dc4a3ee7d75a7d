#include "calib/board/aruco_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/core.hpp>

#include "calib/board/board_detector.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::corner_rms_px;

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

GreyImage render(const Eigen::Isometry3d& pose) {
  return testing::render(draw(aruco_grid()), pose);
}

GreyImage near_view() {
  return render(board_pose(aruco_grid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3}));
}

struct Placement {
  const char* name;
  Eigen::Vector3d angle_axis, centre_m;
  std::size_t min_corners, max_corners;

  friend void PrintTo(const Placement& value, std::ostream* stream) { *stream << value.name; }
};

class PlacedArucoGrid : public ::testing::TestWithParam<Placement> {};

TEST_P(PlacedArucoGrid, CornersAreAccurate) {
  const Placement& placed = GetParam();
  const auto pose = board_pose(aruco_grid(), placed.angle_axis, placed.centre_m);
  const auto [corners, ids] = find_aruco_grid_corners(render(pose), aruco_grid());
  EXPECT_GE(corners.size(), placed.min_corners);
  EXPECT_LE(corners.size(), placed.max_corners);
  const double error_px = corner_rms_px(aruco_grid(), pose, corners, ids);
  RecordProperty("error_px", std::to_string(error_px));
  EXPECT_LT(error_px, 0.06);
}

INSTANTIATE_TEST_SUITE_P(
    ArucoGrid, PlacedArucoGrid,
    ::testing::Values(Placement{"Near", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3}, 80, 80},
                      Placement{"Far", {0.2, 0.3, 1.4}, {0.0, 0.0, 0.5}, 80, 80},
                      Placement{"InPart", {0.2, 0.3, -0.1}, {0.1, 0.06, 0.28}, 20, 76}),
    [](const auto& placed) { return placed.param.name; });

TEST(ArucoGrid, CalibratesFromPartialViews) {
  BoardDetector detector(aruco_grid());
  for (int i = 0; i < 12; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(testing::calibration_pose(aruco_grid(), i, 0.08, 0.27 + 0.01 * i)));
  const BoardObservations observed = std::move(detector).finish();
  ASSERT_GE(observed.views.size(), 10u);
  EXPECT_TRUE(std::ranges::any_of(observed.views,
                                  [](const auto& view) { return view.corners_px.size() < 80; }));
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.06);
  testing::expect_rendered_camera(found.color);
}

TEST(ArucoGrid, MarkersMayBeTurnedByHalfATurn) {
  const auto pose = board_pose(aruco_grid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.3});
  const GreyImage image = testing::render(draw(aruco_grid(), true), pose);
  const auto [corners, ids] = find_aruco_grid_corners(image, aruco_grid());
  EXPECT_EQ(corners.size(), 80u);
  EXPECT_LT(corner_rms_px(aruco_grid(), pose, corners, ids), 0.06);
  const auto seen = recognize_target(image, chessboard_kind);
  ASSERT_TRUE(seen);
  EXPECT_NE(seen->seen.find("5 in a row"), std::string::npos) << seen->seen;
  EXPECT_FALSE(aruco_grid_kind.find_other(image, aruco_grid()));
  CalibrationTarget asked = aruco_grid();
  asked.columns = 8;
  const auto other = aruco_grid_kind.find_other(image, asked);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->seen, "no grid with 4 tags in a row but one with 5");
}

TEST(ArucoGrid, TellsHowManyTagsARowHas) {
  CalibrationTarget asked = aruco_grid();
  EXPECT_FALSE(aruco_grid_kind.find_other(near_view(), asked));
  asked.columns = 8;
  EXPECT_TRUE(find_aruco_grid_corners(near_view(), asked).corners_px.empty());
  const auto other = aruco_grid_kind.find_other(near_view(), asked);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->seen, "no grid with 4 tags in a row but one with 5");
}

TEST(ArucoGrid, IsRecognizedWhereAnotherKindWasAskedFor) {
  for (const TargetKind* kind : target_kinds()) {
    if (kind == &aruco_grid_kind) continue;
    const auto other = recognize_target(near_view(), *kind);
    ASSERT_TRUE(other) << kind->name;
    EXPECT_EQ(other->seen, "a grid of 5x5_1000 markers with 5 in a row") << kind->name;
  }
  EXPECT_FALSE(recognize_target(near_view(), aruco_grid_kind));
}

TEST(ArucoGrid, RejectsImpossibleTargets) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  EXPECT_TRUE(find_aruco_grid_corners(plain, aruco_grid()).corners_px.empty());
  CalibrationTarget grid = aruco_grid();
  grid.markers->side_m = grid.square_m;
  EXPECT_THROW(find_aruco_grid_corners(plain, grid), Error);
  grid = aruco_grid();
  grid.columns = grid.rows = 22;
  EXPECT_THROW(find_aruco_grid_corners(plain, grid), Error);
  grid = aruco_grid();
  grid.markers->dictionary = "5x5_99";
  EXPECT_THROW(find_aruco_grid_corners(plain, grid), Error);
}

}  // namespace
}  // namespace touchtrace
