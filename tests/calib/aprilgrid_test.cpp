#include "calib/board/aprilgrid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/aruco.hpp>

#include "calib/board/board_detector.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::corner_rms_px;

/// 6x4 tags of 25 mm with a gap of 30 %.
CalibrationTarget aprilgrid() {
  return {12, 8, 0.0325, CalibrationTarget::Markers{"apriltag_36h11", 0.025}, &aprilgrid_kind};
}

/// The grid as kalibr prints it: tags turned by 180 degrees with respect to OpenCV's, numbered from
/// the lower left one, and black squares at their corners.
testing::BoardPrint draw(const CalibrationTarget& target, int border_bits) {
  const auto px = [](double m) { return int(std::lround(m * testing::print_px_per_m)); };
  const int pitch = px(target.square_m), side = px(target.markers->side_m), gap = pitch - side;
  const int tag_columns = target.columns / 2, tag_rows = target.rows / 2;
  cv::Mat drawing(tag_rows * pitch + 3 * gap, tag_columns * pitch + 3 * gap, CV_8U,
                  cv::Scalar(255));
  for (int y = 0; y <= tag_rows; ++y)
    for (int x = 0; x <= tag_columns; ++x)
      drawing(cv::Rect(gap + x * pitch, gap + y * pitch, gap, gap)) = 0;
  for (int id = 0; id < tag_columns * tag_rows; ++id) {
    cv::Mat tag;
    cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11)
        ->drawMarker(id, side, tag, border_bits);
    cv::rotate(tag, tag, cv::ROTATE_180);
    const int x = id % tag_columns, y = tag_rows - 1 - id / tag_columns;
    tag.copyTo(drawing(cv::Rect(2 * gap + x * pitch, 2 * gap + y * pitch, side, side)));
  }
  return {drawing, Eigen::Vector2d::Constant(2.0 * gap / testing::print_px_per_m)};
}

GreyImage render(const Eigen::Isometry3d& pose, int border_bits = 2) {
  return testing::render(draw(aprilgrid(), border_bits), pose);
}

struct Placement {
  const char* name;
  Eigen::Vector3d angle_axis, centre_m;
  int border_bits;
  std::size_t min_corners, max_corners;

  friend void PrintTo(const Placement& value, std::ostream* stream) { *stream << value.name; }
};

class PlacedAprilGrid : public ::testing::TestWithParam<Placement> {};

TEST_P(PlacedAprilGrid, CornersAreAccurate) {
  const Placement& placed = GetParam();
  const auto pose = board_pose(aprilgrid(), placed.angle_axis, placed.centre_m);
  const auto [corners, ids] = find_aprilgrid_corners(render(pose, placed.border_bits), aprilgrid());
  EXPECT_GE(corners.size(), placed.min_corners);
  EXPECT_LE(corners.size(), placed.max_corners);
  const double error_px = corner_rms_px(aprilgrid(), pose, corners, ids);
  RecordProperty("error_px", std::to_string(error_px));
  EXPECT_LT(error_px, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    AprilGrid, PlacedAprilGrid,
    ::testing::Values(Placement{"Near", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}, 2, 96, 96},
                      Placement{"BorderOfOneBit", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}, 1, 96, 96},
                      Placement{"Far", {0.2, 0.3, 1.4}, {0.0, 0.0, 0.4}, 2, 96, 96},
                      Placement{"InPart", {0.2, 0.3, -0.1}, {0.1, 0.06, 0.26}, 2, 20, 80}),
    [](const auto& placed) { return placed.param.name; });

TEST(AprilGrid, CalibratesFromPartialViews) {
  BoardDetector detector(aprilgrid());
  for (int i = 0; i < 12; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(testing::calibration_pose(aprilgrid(), i, 0.08, 0.24 + 0.01 * i)));
  const BoardObservations observed = std::move(detector).finish();
  ASSERT_GE(observed.views.size(), 10u);
  EXPECT_TRUE(std::ranges::any_of(observed.views,
                                  [](const auto& view) { return view.corners_px.size() < 96; }));
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.1);
  testing::expect_rendered_camera(found.color);
}

/// Message of `calibrate`'s error.
std::string refusal(const BoardObservations& observed) {
  try {
    calibrate(observed);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(AprilGrid, RefusesAnotherSpacing) {
  CalibrationTarget asked = aprilgrid();
  asked.square_m = 0.03;
  BoardDetector detector(asked);
  for (int i = 0; i < 8; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(testing::calibration_pose(aprilgrid(), i, 0.08, 0.24 + 0.01 * i)));
  EXPECT_NE(refusal(std::move(detector).finish()).find("of 0.3 of their side, not 0.2"),
            std::string::npos);
}

TEST(AprilGrid, FindsNothingWithoutATarget) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  EXPECT_TRUE(find_aprilgrid_corners(plain, aprilgrid()).corners_px.empty());
  EXPECT_TRUE(find_aprilgrid_corners({1, 1, {0}}, aprilgrid()).corners_px.empty());
}

TEST(AprilGrid, TellsHowManyTagsARowHas) {
  const auto image = render(board_pose(aprilgrid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}));
  CalibrationTarget asked = aprilgrid();
  EXPECT_FALSE(aprilgrid_kind.find_other(image, asked));
  asked.columns = 10;
  EXPECT_TRUE(find_aprilgrid_corners(image, asked).corners_px.empty());
  const auto other = aprilgrid_kind.find_other(image, asked);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->seen, "no grid with 5 tags in a row but one with 6");
}

TEST(AprilGrid, IsRecognizedWhereAnotherKindWasAskedFor) {
  const auto image = render(board_pose(aprilgrid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}));
  for (const TargetKind* kind : target_kinds()) {
    if (kind == &aprilgrid_kind) continue;
    const auto other = recognize_target(image, *kind);
    ASSERT_TRUE(other) << kind->name;
    EXPECT_EQ(other->seen, "an AprilGrid with 6 tags in a row") << kind->name;
  }
}

TEST(AprilGrid, RejectsImpossibleTargets) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  CalibrationTarget target = aprilgrid();
  target.markers->side_m = target.square_m;
  EXPECT_THROW(find_aprilgrid_corners(plain, target), Error);
  target = aprilgrid();
  target.columns = target.rows = 60;
  EXPECT_THROW(find_aprilgrid_corners(plain, target), Error);
}

}  // namespace
}  // namespace touchtrace
