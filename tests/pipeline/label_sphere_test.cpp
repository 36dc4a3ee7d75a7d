#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/estimate/learn_shape.h"
#include "pipeline/label/estimate/sphere_fit.h"
#include "tests/pipeline/drawn_body.h"

namespace touchtrace::label {
namespace {

constexpr double radius_m = 0.03;

BodyView view_sphere(const IsHidden& is_hidden) {
  return draw({Eigen::Vector3d::Zero(), radius_m},
              Eigen::Isometry3d(Eigen::Translation3d(drawn_at)), is_hidden);
}

double error_m(const BodyView& view) {
  return (fit_sphere(view, radius_m).centre_m - drawn_at).norm();
}

TEST(FitSphere, FindsAFreeSphereWithinItsNoise) {
  const auto view = view_sphere(nothing_hidden);
  EXPECT_LT(error_m(view),
            5.0 * drawn_noise_m / std::sqrt(static_cast<double>(view.surface_points.size())));
}

TEST(FitSphere, IsNotBiasedByFingersInFront) {
  const auto half = view_sphere([](double x, double) { return x < 0.0; });
  EXPECT_LT(error_m(half), drawn_noise_m);
  EXPECT_GT(std::abs((half.centroid_m() - drawn_at).x()), 8.0 * drawn_noise_m);
  EXPECT_LT(
      error_m(view_sphere([](double x, double) { return std::fmod(x + 0.06, 0.025) < 0.018; })),
      drawn_noise_m);
  EXPECT_LT(error_m(view_sphere([](double, double y) { return y > -0.015; })), 2.0 * drawn_noise_m);
}

TEST(FitSphere, GivesLessInformationForAPartlyHiddenSphere) {
  const auto information = [](const BodyView& view) {
    return fit_sphere(view, radius_m).information.trace();
  };
  // a third of the surface, and less of the silhouette, gives under half the information
  EXPECT_GT(information(view_sphere(nothing_hidden)),
            2.0 * information(view_sphere([](double, double y) { return y > -0.01; })));
}

TEST(FitSphere, CostIsLeastForTheTrueRadius) {
  const auto view = view_sphere([](double x, double) { return x < -0.005; });
  const double cost = fit_sphere(view, radius_m).cost_m2;
  EXPECT_LT(cost, fit_sphere(view, 0.9 * radius_m).cost_m2);
  EXPECT_LT(cost, fit_sphere(view, 1.1 * radius_m).cost_m2);
}

/// Depth noise of 2 mm.
TEST(LearnShape, LearnsASpheresRadiusInDepthNoise) {
  std::vector<BodyView> views;
  for (std::uint64_t seed = 1; seed <= 24; ++seed)
    views.push_back(draw({Eigen::Vector3d::Zero(), radius_m},
                         Eigen::Isometry3d(Eigen::Translation3d(drawn_at)), nothing_hidden, seed,
                         0.002));
  for (const double silhouette_m : {0.025, 0.029, 0.034})
    EXPECT_NEAR(learn_shape(views, silhouette_m, 1).radius_m, radius_m, 0.005 * radius_m);
}

/// A randomly rotated egg: the fitted sphere leans towards the visible end.
TEST(LearnShape, CentreSigmaOfAnEggMatchesItsErrors) {
  RandomStream random(1, "turns");
  std::vector<BodyView> views;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Eigen::Vector4d turn(random.normal(), random.normal(), random.normal(), random.normal());
    views.push_back(draw({{0.0, 0.0, 0.007}, 0.0215},
                         Eigen::Translation3d(drawn_at) * Eigen::Quaterniond(turn.normalized()),
                         nothing_hidden, seed));
  }
  const auto shape = learn_shape(views, 0.024, 1);
  ASSERT_FALSE(shape.body);
  double across_m2 = 0.0;
  for (const auto& view : views)
    across_m2 += (fit_sphere(view, shape.radius_m).centre_m - drawn_at).head<2>().squaredNorm();
  const double across_m = std::sqrt(across_m2 / (2.0 * static_cast<double>(views.size())));
  EXPECT_GT(shape.centre_sigma_m, 0.7 * across_m);
  EXPECT_LT(shape.centre_sigma_m, 1.4 * across_m);
}

TEST(FitSphere, IsFiniteForASinglePoint) {
  EXPECT_TRUE(fit_sphere({Eigen::Vector3d::Zero(), {{0.0f, 0.0f, 1.0f}}, {}}, radius_m)
                  .centre_m.allFinite());
}

}  // namespace
}  // namespace touchtrace::label
