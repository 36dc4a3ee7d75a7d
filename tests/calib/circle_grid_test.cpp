#include "calib/board/circle_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "calib/board/board_detector.h"
#include "calib/board/local_homography.h"
#include "calib/rgbd/calibrate.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::corner_rms_px;

const CalibrationTarget symmetric{7, 5, 0.03, {}, &circles_kind};
const CalibrationTarget asymmetric{4, 11, 0.02, {}, &asymmetric_circles_kind};

double radius_m(const CalibrationTarget& target) { return 0.3 * target.square_m; }

testing::BoardPrint draw(const CalibrationTarget& target) {
  constexpr int finer_bits = 4;
  const double margin_m = target.square_m;
  const auto px = [](double m) { return m * testing::print_px_per_m; };
  cv::Mat drawing(int(px(target.size_m().y() + 2.0 * margin_m + target.square_m)),
                  int(px(target.size_m().x() + 2.0 * margin_m + target.square_m)), CV_8U,
                  cv::Scalar(255));
  for (int i = 0; i < target.num_corners(); ++i) {
    const Eigen::Vector2d centre_px =
        ((target.corner_m(i).head<2>().array() + margin_m) * testing::print_px_per_m - 0.5) *
        (1 << finer_bits);
    cv::circle(drawing, {int(std::lround(centre_px.x())), int(std::lround(centre_px.y()))},
               int(std::lround(px(radius_m(target)) * (1 << finer_bits))), cv::Scalar(0),
               cv::FILLED, cv::LINE_AA, finer_bits);
  }
  return {drawing, Eigen::Vector2d::Constant(margin_m)};
}

GreyImage render(const CalibrationTarget& target, const Eigen::Isometry3d& pose) {
  return testing::render(draw(target), pose);
}

std::vector<int> all_ids(const CalibrationTarget& target) {
  std::vector<int> ids(std::size_t(target.num_corners()));
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

struct Placement {
  const char* name;
  const CalibrationTarget& target;
  Eigen::Vector3d angle_axis, centre_m;

  friend void PrintTo(const Placement& value, std::ostream* stream) { *stream << value.name; }
};

class PlacedCircles : public ::testing::TestWithParam<Placement> {};

/// RMS distance of the centres of the circles' images from the images of the centres.
double perspective_offset_px(const CalibrationTarget& target, const Eigen::Isometry3d& pose) {
  TargetCorners truth{{}, all_ids(target)};
  for (int id : truth.second)
    truth.first.push_back((testing::rendered_camera * (pose * target.corner_m(id))).hnormalized());
  double squares = 0.0;
  for (int id : truth.second) {
    const Eigen::Vector2d place_m = target.corner_m(id).head<2>();
    const auto local = LocalHomography::fit(truth, target, place_m);
    squares += (local->ellipse_centre(place_m, radius_m(target)) - truth.first[std::size_t(id)])
                   .squaredNorm();
  }
  return std::sqrt(squares / target.num_corners());
}

TEST_P(PlacedCircles, CentresAreAccurate) {
  const auto& [name, target, angle_axis, centre_m] = GetParam();
  const auto pose = board_pose(target, angle_axis, centre_m);
  auto centres = find_circle_centres(render(target, pose), target).first;
  ASSERT_EQ(int(centres.size()), target.num_corners());
  const auto ids = all_ids(target);
  double error_px = corner_rms_px(target, pose, centres, ids);
  if (target.is_symmetric()) {
    std::ranges::reverse(centres);
    error_px = std::min(error_px, corner_rms_px(target, pose, centres, ids));
  }
  RecordProperty("error_px", std::to_string(error_px));
  RecordProperty("offset_px", std::to_string(perspective_offset_px(target, pose)));
  EXPECT_LT(error_px, 0.03);
}

INSTANTIATE_TEST_SUITE_P(
    CircleGrid, PlacedCircles,
    ::testing::Values(Placement{"Symmetric", symmetric, {0.4, -0.3, 0.2}, {0.0, 0.0, 0.4}},
                      Placement{"SymmetricTilted", symmetric, {0.1, -0.9, 0.0}, {0.0, 0.0, 0.35}},
                      Placement{"Asymmetric", asymmetric, {0.4, -0.3, 0.2}, {0.0, 0.0, 0.4}},
                      Placement{"AsymmetricTilted", asymmetric, {0.1, -0.9, 0.0}, {0.0, 0.0, 0.36}},
                      Placement{"Far", asymmetric, {0.2, 0.3, 1.4}, {0.05, 0.0, 0.7}}),
    [](const auto& placed) { return placed.param.name; });

/// The correction matters: without it this view would miss the bound above.
TEST(CircleGrid, PerspectiveMovesTheCentresOfCircles) {
  EXPECT_GT(
      perspective_offset_px(symmetric, board_pose(symmetric, {0.1, -0.9, 0.0}, {0.0, 0.0, 0.35})),
      0.06);
}

class CircleGridCalibration : public ::testing::TestWithParam<const CalibrationTarget*> {};

TEST_P(CircleGridCalibration, RecoversTheCamera) {
  const CalibrationTarget& target = *GetParam();
  BoardDetector detector(target);
  for (int i = 0; i < 12; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(target, testing::calibration_pose(target, i, 0.06, 0.45 + 0.02 * i)));
  const BoardObservations observed = std::move(detector).finish();
  ASSERT_GE(observed.views.size(), 10u);
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.03);
  testing::expect_rendered_camera(found.color);
}

INSTANTIATE_TEST_SUITE_P(CircleGrid, CircleGridCalibration,
                         ::testing::Values(&symmetric, &asymmetric), [](const auto& target) {
                           return target.param == &symmetric ? "Symmetric" : "Asymmetric";
                         });

TEST(CircleGrid, FindsNothingWithoutATarget) {
  const GreyImage plain{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};
  EXPECT_TRUE(find_circle_centres(plain, symmetric).first.empty());
  EXPECT_TRUE(find_circle_centres({1, 1, {0}}, asymmetric).first.empty());
}

}  // namespace
}  // namespace touchtrace
