#include "calib/camera/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>

#include "calib/camera/projection_jacobian.h"
#include "engine/base/random.h"
#include "tests/support/compare.h"

namespace touchtrace {
namespace {

using Coefficients = std::array<double, max_coefficients>;

/// Realistic coefficients of strongly distorting lenses.
const std::map<std::string, Coefficients> strong_distortion{
    {"none", {}},
    {"radtan4", {-0.28, 0.09, 0.0012, -0.0007}},
    {"radtan5", {-0.28, 0.09, 0.0012, -0.0007, 0.02}},
    {"rational8", {0.6, 0.1, 0.0012, -0.0007, 0.01, 0.9, 0.3, 0.02}},
    {"fisheye4", {0.02, -0.015, 0.006, -0.001}}};

Camera camera_with(const Lens& lens) {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.lens = lens;
  camera.set_parameters({533.0, 531.0, 342.0, 235.0});
  const Coefficients& k = strong_distortion.at(lens_name(lens));
  camera.distortion = Eigen::Map<const Eigen::Matrix<double, max_coefficients, 1>>(k.data());
  return camera;
}

Eigen::Vector3d random_point(RandomStream& random) {
  const double z = random.uniform(0.3, 3.0), x = z * random.uniform(-0.5, 0.5);
  return {x, z * random.uniform(-0.4, 0.4), z};
}

class EveryLens : public ::testing::TestWithParam<Lens> {
 protected:
  const Camera camera_ = camera_with(GetParam());
};

std::vector<cv::Point2d> opencv_project(const Camera& camera, const Eigen::Vector3d& p) {
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<cv::Point3d> points{{p.x(), p.y(), p.z()}};
  std::vector<cv::Point2d> pixels;
  if (is_perspective(camera.lens))
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix,
                      std::vector<double>(camera.distortion.begin(), camera.distortion.end()),
                      pixels);
  else
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrix,
                               cv::Vec4d(camera.distortion.data()));
  return pixels;
}

TEST_P(EveryLens, ProjectsLikeOpenCv) {
  RandomStream random(1, "points");
  for (int i = 0; i < 200; ++i) {
    const auto p = random_point(random);
    const auto expected = opencv_project(camera_, p);
    const Eigen::Vector2d pixel = camera_.project(p);
    EXPECT_TRUE(
        testing::close<double>({pixel.data(), 2}, std::array{expected[0].x, expected[0].y}, 8, 30));
  }
}

TEST_P(EveryLens, UnprojectInvertsProject) {
  RandomStream random(2, "points");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = random_point(random);
    const Eigen::Vector3d ray = camera_.unproject(camera_.project(p));
    ASSERT_TRUE(ray.allFinite());
    const Eigen::Vector3d ideal = p / p.z();
    // Rounding of a pixel coordinate, 1e-13 px at 640 px, is 2e-16 of the ray, times the inverse
    // Jacobian (< 5).
    EXPECT_LT((ray - ideal).norm(), 1e-13);
  }
}

TEST_P(EveryLens, ProjectsTheOpticalAxisToThePrincipalPoint) {
  const Eigen::Vector2d centre(camera_.cx, camera_.cy);
  EXPECT_EQ(camera_.project({0.0, 0.0, 2.0}), centre);
  EXPECT_LT((camera_.unproject(centre) - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_TRUE(camera_.project({1e-9, -1e-9, 1.0}).allFinite());
}

TEST_P(EveryLens, BatchProjectionEqualsSingleProjection) {
  RandomStream random(4, "points");
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20; ++i) points.push_back(random_point(random).cast<float>());
  std::vector<Eigen::Vector2d> pixels(points.size());
  camera_.project(points, pixels);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(pixels[i], camera_.project(points[i].cast<double>()));
}

TEST_P(EveryLens, HasAUniqueName) {
  const auto found = find_lens(lens_name(GetParam()));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->index(), GetParam().index());
  EXPECT_FALSE(find_lens("radtan3").has_value());
}

/// Inputs of a projection: intrinsics, then the point.
constexpr int inputs = max_intrinsics + 3;

Eigen::Vector2d project_shifted(Camera camera, Eigen::Vector3d p, int input, double step) {
  auto values = camera.parameters();
  if (input < max_intrinsics) values[input] += step;
  if (input >= max_intrinsics) p[input - max_intrinsics] += step;
  camera.set_parameters(values);
  return camera.project(p);
}

TEST_P(EveryLens, ProjectionJacobianMatchesCentralDifferences) {
  RandomStream random(3, "points");
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = random_point(random);
    const ProjectionJacobian projection = projection_jacobian(camera_, p);
    EXPECT_LT((projection.pixel - camera_.project(p)).norm(), 1e-9);
    Eigen::Matrix<double, 2, inputs> jacobian;
    jacobian << projection.by_intrinsics, projection.by_point;
    ASSERT_TRUE(jacobian.allFinite());
    for (int k = 0; k < inputs; ++k) {
      const double step = k < 4 ? 1e-2 : 1e-5;
      const Eigen::Vector2d difference =
          (project_shifted(camera_, p, k, step) - project_shifted(camera_, p, k, -step)) /
          (2.0 * step);
      // Rounding of a pixel over the step, 1e-13 / 1e-5, and the third derivative times step^2 / 6:
      // at z >= 0.3 both are below 2e-7 of the column's scale.
      EXPECT_LT((jacobian.col(k) - difference).norm(), 2e-7 * (1.0 + difference.norm()))
          << "input " << k;
    }
  }
}

TEST_P(EveryLens, ProjectionJacobianIsNanWhereTheLensCannotProject) {
  const ProjectionJacobian projection = projection_jacobian(camera_, {0.0, 0.0, -1.0});
  EXPECT_TRUE(projection.pixel.array().isNaN().all());
  EXPECT_TRUE(projection.by_point.array().isNaN().all());
}

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, ::testing::ValuesIn(all_lenses()),
                         [](const auto& lens) { return lens_name(lens.param); });

TEST(Camera, UnprojectIsNanWhereNotInvertible) {
  auto camera = camera_with(Radtan5{});
  camera.distortion.setZero();
  camera.distortion[0] = -0.3;  // r (1 - 0.3 r^2) has its maximum 0.703 at r = 1.054
  EXPECT_TRUE(camera.unproject({camera.cx + 0.70 * camera.fx, camera.cy}).allFinite());
  EXPECT_FALSE(camera.unproject({camera.cx + 0.71 * camera.fx, camera.cy}).allFinite());
}

TEST(Camera, OnlyAFisheyeProjectsPointsBehindTheImagePlane) {
  const Eigen::Vector3d behind(1.0, 0.2, -0.1);
  EXPECT_FALSE(camera_with(Radtan4{}).project(behind).allFinite());
  const Camera fisheye = camera_with(Fisheye4{});
  const Eigen::Vector2d pixel = fisheye.project(behind);
  EXPECT_TRUE(pixel.allFinite());
  EXPECT_FALSE(fisheye.unproject(pixel).allFinite());  // not a ray (X/Z, Y/Z, 1)
  EXPECT_FALSE(fisheye.project({0.0, 0.0, -1.0}).allFinite());
}

}  // namespace
}  // namespace touchtrace
