#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/learn_shape.h"
#include "pipeline/label/sphere_fit.h"
#include "tests/pipeline/drawn_body.h"

namespace touchtrace::label {
namespace {

constexpr double radius_m = 0.03;

BodyView look(const Hides& hides) {
  return draw({Eigen::Vector3d::Zero(), radius_m},
              Eigen::Isometry3d(Eigen::Translation3d(drawn_at)), hides);
}

double error_m(const BodyView& view) {
  return (fit_sphere(view, radius_m).center_m - drawn_at).norm();
}

TEST(LabelSphere, AFreeSphereIsFoundWithinItsNoise) {
  const auto view = look(nothing_hides);
  EXPECT_LT(error_m(view), 5.0 * drawn_noise_m / std::sqrt(static_cast<double>(view.on_m.size())));
}

TEST(LabelSphere, FingersBeforeItDoNotMoveIt) {
  const auto half = look([](double x, double) { return x < 0.0; });
  EXPECT_LT(error_m(half), drawn_noise_m);
  EXPECT_GT(std::abs((centroid(half) - drawn_at).x()), 8.0 * drawn_noise_m);
  EXPECT_LT(error_m(look([](double x, double) { return std::fmod(x + 0.06, 0.025) < 0.018; })),
            drawn_noise_m);
  EXPECT_LT(error_m(look([](double, double y) { return y > -0.015; })), 2.0 * drawn_noise_m);
}

TEST(LabelSphere, WhatIsSeenLessIsKnownLess) {
  const auto known = [](const BodyView& view) {
    return fit_sphere(view, radius_m).information.trace();
  };
  EXPECT_GT(known(look(nothing_hides)),
            2.0 * known(look([](double, double y) { return y > -0.01; })));
}

TEST(LabelSphere, TheRightRadiusCostsLeast) {
  const auto view = look([](double x, double) { return x < -0.005; });
  const double cost = fit_sphere(view, radius_m).cost_m2;
  EXPECT_LT(cost, fit_sphere(view, 0.9 * radius_m).cost_m2);
  EXPECT_LT(cost, fit_sphere(view, 1.1 * radius_m).cost_m2);
}

/// Depths err by 2 mm, points of the surface by much less.
TEST(LabelSphere, ItsRadiusIsLearntThroughNoise) {
  std::vector<BodyView> views;
  for (std::uint64_t seed = 1; seed <= 24; ++seed)
    views.push_back(draw({Eigen::Vector3d::Zero(), radius_m},
                         Eigen::Isometry3d(Eigen::Translation3d(drawn_at)), nothing_hides, seed,
                         0.002));
  for (const double silhouette_m : {0.025, 0.029, 0.034})
    EXPECT_NEAR(learn_shape(views, silhouette_m, 1).radius_m, radius_m, 0.005 * radius_m);
}

/// An egg as it may lie: the sphere leans on the end that shows.
TEST(LabelSphere, TheMiddleOfWhatIsLongIsKnownLess) {
  RandomStream random(1, "turns");
  std::vector<BodyView> views;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Eigen::Vector4d turn(random.normal(), random.normal(), random.normal(), random.normal());
    views.push_back(draw({{0.0, 0.0, 0.007}, 0.0215},
                         Eigen::Translation3d(drawn_at) * Eigen::Quaterniond(turn.normalized()),
                         nothing_hides, seed));
  }
  const auto shape = learn_shape(views, 0.024, 1);
  ASSERT_FALSE(shape.body);
  double across_m2 = 0.0;
  for (const auto& view : views)
    across_m2 += (fit_sphere(view, shape.radius_m).center_m - drawn_at).head<2>().squaredNorm();
  const double across_m = std::sqrt(across_m2 / (2.0 * static_cast<double>(views.size())));
  EXPECT_GT(shape.middle_sigma_m, 0.7 * across_m);
  EXPECT_LT(shape.middle_sigma_m, 1.4 * across_m);
}

TEST(LabelSphere, OnePointIsEnoughForAnAnswer) {
  EXPECT_TRUE(fit_sphere({{}, {{0.0f, 0.0f, 1.0f}}, {}}, radius_m).center_m.allFinite());
}

}  // namespace
}  // namespace touchtrace::label
