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

/// A sphere fitted to randomly rotated eggs, of which `visible` of the width is not hidden.
struct HiddenEgg {
  double sigma_m, error_m;
};

HiddenEgg fit_hidden_eggs(double half_length_m, double visible) {
  constexpr double egg_radius_m = 0.0215;
  const double box_radius_m = egg_radius_m + 0.5 * half_length_m;
  RandomStream random(1, "turns");
  std::vector<BodyView> views;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Eigen::Vector4d turn(random.normal(), random.normal(), random.normal(), random.normal());
    views.push_back(draw(
        {{0.0, 0.0, half_length_m}, egg_radius_m},
        Eigen::Translation3d(drawn_at) * Eigen::Quaterniond(turn.normalized()),
        [&](double x, double) { return x < (1.0 - 2.0 * visible) * box_radius_m; }, seed));
  }
  const auto shape = learn_shape(views, box_radius_m, 1);
  double error_m2 = 0.0;
  for (const auto& view : views)
    error_m2 += (fit_sphere(view, shape.radius_m).centre_m - drawn_at).squaredNorm();
  return {hidden_sphere_centre_sigma_m(shape, visible, box_radius_m),
          std::sqrt(error_m2 / (3.0 * static_cast<double>(views.size())))};
}

TEST(LearnShape, CentreSigmaOfAHiddenEggMatchesItsErrors) {
  EXPECT_LT(fit_hidden_eggs(0.0, 0.5).sigma_m, 0.001) << "a ball";
  for (const double half_length_m : {0.007, 0.012})
    for (const double visible : {0.4, 0.5}) {
      const auto [sigma_m, error_m] = fit_hidden_eggs(half_length_m, visible);
      EXPECT_GT(sigma_m, 0.6 * error_m) << half_length_m << ", " << visible;
      EXPECT_LT(sigma_m, 1.4 * error_m) << half_length_m << ", " << visible;
    }
}

TEST(LearnShape, LittleUnevennessOfASmallCapTellsLittle) {
  const ObjectShape sphere{radius_m, std::nullopt, 0.00075, 0.002};
  EXPECT_DOUBLE_EQ(hidden_sphere_centre_sigma_m(sphere, 0.9, radius_m), 0.002);
  EXPECT_DOUBLE_EQ(hidden_sphere_centre_sigma_m(sphere, 0.375, radius_m), 0.008);
}

TEST(FitSphere, IsFiniteForASinglePoint) {
  EXPECT_TRUE(fit_sphere({Eigen::Vector3d::Zero(), {{0.0f, 0.0f, 1.0f}}, {}}, radius_m)
                  .centre_m.allFinite());
}

}  // namespace
}  // namespace touchtrace::label
