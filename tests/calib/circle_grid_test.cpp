#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "calib/board/circle_image.h"
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

TargetCorners find_centres(const GreyImage& image, const CalibrationTarget& target) {
  return target.kind->find_corners(image, target);
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
  for (int id : truth.ids)
    truth.corners_px.push_back(
        (testing::rendered_camera * (pose * target.corner_m(id))).hnormalized());
  double squares = 0.0;
  for (int id : truth.ids) {
    const Eigen::Vector2d place_m = target.corner_m(id).head<2>();
    squares += CircleImage::fit(truth, target, place_m)
                   ->centroid_offset_px(radius_m(target))
                   .squaredNorm();
  }
  return std::sqrt(squares / target.num_corners());
}

TEST_P(PlacedCircles, CentresAreAccurate) {
  const auto& [name, target, angle_axis, centre_m] = GetParam();
  const auto pose = board_pose(target, angle_axis, centre_m);
  auto centres = find_centres(render(target, pose), target).corners_px;
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

/// The near side of a large tilted circle is longer than the far side. Half of each circle reflects
/// light, as thermal and glossy boards do, and the board is dim. The reflection is a quarter of the
/// contrast, so that the level half way between dark and light is 0.12 px away on that half's edge.
TEST(CircleGrid, LargeTiltedDimReflectingCircles) {
  const CalibrationTarget large{4, 3, 0.06, {}, &circles_kind};
  const auto pose = board_pose(large, {0.3, -0.9, 0.1}, {0.02, 0.0, 0.4});
  testing::BoardPrint print = draw(large);
  cv::Mat reflecting = print.pixels.clone();
  for (int i = 0; i < large.num_corners(); ++i) {
    const auto px = [](double m) { return int(m * testing::print_px_per_m); };
    const Eigen::Vector2d corner_m =
        large.corner_m(i).head<2>() + print.origin_m - Eigen::Vector2d(0.0, 0.03);
    reflecting(cv::Rect(px(corner_m.x()), px(corner_m.y()), px(0.03), px(0.06)))
        .setTo(60,
               print.pixels(cv::Rect(px(corner_m.x()), px(corner_m.y()), px(0.03), px(0.06))) == 0);
  }
  print.pixels = 0.18 * reflecting;
  auto centres = find_centres(testing::render(print, pose), large).corners_px;
  ASSERT_EQ(int(centres.size()), large.num_corners());
  const auto ids = all_ids(large);
  const double error_px = corner_rms_px(large, pose, centres, ids);
  std::ranges::reverse(centres);
  EXPECT_LT(std::min(error_px, corner_rms_px(large, pose, centres, ids)), 0.2);
}

/// Pixel of a place on a tilted target through a lens with strong barrel distortion.
Eigen::Vector2d through_barrel(const Eigen::Isometry3d& pose, const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d ray = (pose * Eigen::Vector3d(place_m.x(), place_m.y(), 0.0)).hnormalized();
  return 400.0 * ray * std::atan(ray.norm()) / ray.norm();
}

TEST(CircleImage, OffsetOfTheCentroidBehindADistortingLens) {
  const CalibrationTarget target{5, 5, 0.06, {}, &circles_kind};
  const auto pose = board_pose(target, {0.3, -0.6, 0.1}, {0.1, 0.05, 0.25});
  TargetCorners truth{{}, all_ids(target)};
  for (int id : truth.ids)
    truth.corners_px.push_back(through_barrel(pose, target.corner_m(id).head<2>()));
  const Eigen::Vector2d centre_m = target.corner_m(12).head<2>();
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double area = 0.0;
  constexpr int steps = 400;
  for (int i = 0; i < steps * steps; ++i) {
    const Eigen::Vector2d p_m =
        2.0 * radius_m(target) *
        Eigen::Vector2d((i % steps + 0.5) / steps - 0.5, (i / steps + 0.5) / steps - 0.5);
    if (p_m.norm() > radius_m(target)) continue;
    const double h = 1e-5;
    const Eigen::Vector2d pixel = through_barrel(pose, centre_m + p_m);
    Eigen::Matrix2d derivative;
    derivative << through_barrel(pose, centre_m + p_m + Eigen::Vector2d(h, 0.0)) - pixel,
        through_barrel(pose, centre_m + p_m + Eigen::Vector2d(0.0, h)) - pixel;
    area += std::abs(derivative.determinant()),
        moment += std::abs(derivative.determinant()) * pixel;
  }
  const Eigen::Vector2d offset_px = moment / area - through_barrel(pose, centre_m);
  ASSERT_GT(offset_px.norm(), 0.2);
  const auto found_px =
      CircleImage::fit(truth, target, centre_m)->centroid_offset_px(radius_m(target));
  EXPECT_LT((found_px - offset_px).norm(), 0.15 * offset_px.norm())
      << found_px.transpose() << " instead of " << offset_px.transpose();
}

class CircleGridCalibration : public ::testing::TestWithParam<const CalibrationTarget*> {};

TEST_P(CircleGridCalibration, RecoversTheCamera) {
  const CalibrationTarget& target = *GetParam();
  testing::expect_calibration(testing::observe(draw(target), target, 0.06, 0.45, 0.02), 0.03);
}

INSTANTIATE_TEST_SUITE_P(CircleGrid, CircleGridCalibration,
                         ::testing::Values(&symmetric, &asymmetric), [](const auto& target) {
                           return target.param == &symmetric ? "Symmetric" : "Asymmetric";
                         });

TEST(CircleGrid, LightCirclesOnADarkBoardAreFoundAtTheSamePlaces) {
  GreyImage image = render(asymmetric, board_pose(asymmetric, {0.3, -0.2, 0.1}, {0.0, 0.0, 0.6}));
  const TargetCorners dark = find_centres(image, asymmetric);
  ASSERT_EQ(dark.corners_px.size(), std::size_t(asymmetric.num_corners()));
  for (auto& grey : image.pixels) grey = static_cast<std::uint8_t>(~grey);
  EXPECT_EQ(find_centres(image, asymmetric).corners_px, dark.corners_px);
}

TEST(CircleGrid, FindsNothingWithoutATarget) {
  EXPECT_TRUE(testing::finds_nothing(testing::plain_image, symmetric));
  EXPECT_TRUE(testing::finds_nothing({1, 1, {0}}, asymmetric));
}

}  // namespace
}  // namespace touchtrace
