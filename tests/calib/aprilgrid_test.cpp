#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>

#include "engine/base/error.h"
#include "tests/calib/rendered_board.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::Placement;

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

GreyImage near_view() {
  return testing::render(draw(aprilgrid(), 2),
                         board_pose(aprilgrid(), {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}));
}

class PlacedAprilGrid : public ::testing::TestWithParam<std::pair<int, Placement>> {};

TEST_P(PlacedAprilGrid, CornersAreAccurate) {
  const auto& [border_bits, placed] = GetParam();
  testing::expect_accurate_corners(draw(aprilgrid(), border_bits), aprilgrid(), placed, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    AprilGrid, PlacedAprilGrid,
    ::testing::Values(
        std::pair(2, Placement{"Near", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}, 96, 96}),
        std::pair(1, Placement{"BorderOfOneBit", {0.4, -0.3, 0.2}, {0.0, 0.0, 0.28}, 96, 96}),
        std::pair(2, Placement{"Far", {0.2, 0.3, 1.4}, {0.0, 0.0, 0.4}, 96, 96}),
        std::pair(2, Placement{"InPart", {0.2, 0.3, -0.1}, {0.1, 0.06, 0.26}, 20, 80})),
    [](const auto& row) { return row.param.second.name; });

TEST(AprilGrid, CalibratesFromPartialViews) {
  const auto observed = testing::observe(draw(aprilgrid(), 2), aprilgrid(), 0.08, 0.24, 0.01);
  EXPECT_TRUE(testing::shows_parts(observed));
  testing::expect_calibration(observed, 0.1);
}

TEST(AprilGrid, RefusesAnotherSpacing) {
  CalibrationTarget asked = aprilgrid();
  asked.square_m = 0.03;
  testing::expect_error(
      [&] { calibrate(testing::observe(draw(aprilgrid(), 2), asked, 0.08, 0.24, 0.01)); },
      "of 0.3 of their side, not 0.2", {});
}

TEST(AprilGrid, FindsNothingWithoutATarget) {
  EXPECT_TRUE(testing::finds_nothing(testing::plain_image, aprilgrid()));
  EXPECT_TRUE(testing::finds_nothing({1, 1, {0}}, aprilgrid()));
}

TEST(AprilGrid, TellsHowManyTagsARowHas) {
  EXPECT_FALSE(aprilgrid_kind.find_other(near_view(), aprilgrid()));
  CalibrationTarget asked = aprilgrid();
  asked.columns = 10;
  testing::expect_other(near_view(), asked, "no grid with 5 tags in a row but one with 6");
}

TEST(AprilGrid, IsRecognizedWhereAnotherKindWasAskedFor) {
  testing::expect_recognized(near_view(), aprilgrid_kind, "an AprilGrid with 6 tags in a row");
}

TEST(AprilGrid, RejectsImpossibleTargets) {
  CalibrationTarget target = aprilgrid();
  target.markers->side_m = target.square_m;
  EXPECT_THROW(testing::finds_nothing(testing::plain_image, target), Error);
  target = aprilgrid();
  target.columns = target.rows = 60;
  EXPECT_THROW(testing::finds_nothing(testing::plain_image, target), Error);
}

}  // namespace
}  // namespace touchtrace
