#include "calib/camera/pinhole.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "engine/base/random.h"
#include "tests/support/compare.h"

namespace touchtrace {
namespace {

PinholeCamera distorted_camera() {
  PinholeCamera camera;
  camera.width = 640, camera.height = 480;
  camera.set_parameters({533.0, 531.0, 342.0, 235.0, -0.28, 0.09, 0.0012, -0.0007, 0.02});
  return camera;
}

Eigen::Vector3d point_before(RandomStream& random) {
  const double z = random.uniform(0.3, 3.0);
  return {z * random.uniform(-0.5, 0.5), z * random.uniform(-0.4, 0.4), z};
}

TEST(Pinhole, ProjectsAsOpenCv) {
  const auto camera = distorted_camera();
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<double> distortion(camera.distortion.data(), camera.distortion.data() + 5);
  RandomStream random(1, "points");
  for (int i = 0; i < 200; ++i) {
    const auto p = point_before(random);
    std::vector<cv::Point2d> expected;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(), cv::Vec3d(),
                      matrix, distortion, expected);
    const Eigen::Vector2d pixel = camera.project(p);
    EXPECT_TRUE(
        testing::close<double>({pixel.data(), 2}, std::array{expected[0].x, expected[0].y}, 8, 30));
  }
}

TEST(Pinhole, UnprojectInvertsProject) {
  const auto camera = distorted_camera();
  RandomStream random(2, "points");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = point_before(random);
    const Eigen::Vector3d ray = camera.unproject(camera.project(p));
    ASSERT_TRUE(ray.allFinite());
    const Eigen::Vector3d ideal = p / p.z();
    // One rounding of a pixel, 1e-13 of 640, is 2e-16 of the ray times the inverse Jacobian (< 2).
    EXPECT_LT((ray - ideal).norm(), 4e-15 * 10);
  }
}

TEST(Pinhole, UnprojectSaysWhereItCannot) {
  auto camera = distorted_camera();
  camera.distortion << -0.3, 0, 0, 0, 0;  // r (1 - 0.3 r^2) has its maximum 0.703 at r = 1.054
  EXPECT_TRUE(camera.unproject({camera.cx + 0.70 * camera.fx, camera.cy}).allFinite());
  EXPECT_FALSE(camera.unproject({camera.cx + 0.71 * camera.fx, camera.cy}).allFinite());
}

/// Derivatives of the pixel by the nine intrinsics and the point, as Ceres takes them.
Eigen::Matrix<double, 2, 12> automatic_jacobian(const PinholeCamera& camera,
                                                const Eigen::Vector3d& p) {
  using Jet = ceres::Jet<double, 12>;
  std::array<Jet, 9> intrinsics;
  for (int i = 0; i < 9; ++i) intrinsics[i] = Jet(camera.parameters()[i], i);
  const Eigen::Matrix<Jet, 3, 1> point(Jet(p.x(), 9), Jet(p.y(), 10), Jet(p.z(), 11));
  const auto pixel = project_point(intrinsics.data(), point);
  Eigen::Matrix<double, 2, 12> jacobian;
  jacobian << pixel.x().v.transpose(), pixel.y().v.transpose();
  return jacobian;
}

Eigen::Vector2d project_shifted(PinholeCamera camera, Eigen::Vector3d p, int parameter,
                                double step) {
  auto values = camera.parameters();
  if (parameter < 9) values[parameter] += step;
  if (parameter >= 9) p[parameter - 9] += step;
  camera.set_parameters(values);
  return camera.project(p);
}

TEST(Pinhole, DerivativesAreThoseOfCentralDifferences) {
  const auto camera = distorted_camera();
  RandomStream random(3, "points");
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = point_before(random);
    const auto jacobian = automatic_jacobian(camera, p);
    ASSERT_TRUE(jacobian.allFinite());
    for (int k = 0; k < 12; ++k) {
      const double step = k < 4 ? 1e-2 : 1e-5;
      const Eigen::Vector2d difference =
          (project_shifted(camera, p, k, step) - project_shifted(camera, p, k, -step)) /
          (2.0 * step);
      // Rounding of a pixel over the step, 1e-13 / 1e-5, and the third derivative times step^2 / 6:
      // at z >= 0.3 both stay below 2e-7 of the column's scale.
      EXPECT_LT((jacobian.col(k) - difference).norm(), 2e-7 * (1.0 + difference.norm()))
          << "parameter " << k;
    }
  }
}

}  // namespace
}  // namespace touchtrace
