#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/random.h"
#include "pipeline/label/sphere_fit.h"

namespace touchtrace::label {
namespace {

using Eigen::Vector3d;

constexpr double radius_m = 0.03, pixel_m = 0.0035, wall_m = 2.0, noise_m = 0.001;
const Vector3d center(0.02, -0.03, 1.1);

/// How a camera at the origin sees the sphere. `hides` says where, in metres right of and below the
/// sphere's middle, something 2 cm before it hides it.
SphereView look(const std::function<bool(double, double)>& hides) {
  RandomStream random(1, "sphere view");
  SphereView view;
  for (double y = -0.06; y <= 0.06; y += pixel_m)
    for (double x = -0.06; x <= 0.06; x += pixel_m) {
      const Vector3d ray = (center + Vector3d(x, y, 0.0)) / center.z();
      const double b = ray.dot(center), q = ray.squaredNorm();
      const double d = b * b - q * (center.squaredNorm() - radius_m * radius_m);
      const double noise = noise_m * random.normal();
      if (hides(x, y))
        view.seen_past_m.push_back(((center.z() - radius_m - 0.02 + noise) * ray).cast<float>());
      else if (d > 0.0)
        view.on_m.push_back((((b - std::sqrt(d)) / q + noise) * ray).cast<float>());
      else
        view.seen_past_m.push_back((wall_m * ray).cast<float>());
    }
  return view;
}

double error_m(const SphereView& view) {
  return (fit_sphere(view, radius_m).center_m - center).norm();
}

Vector3d centroid(const SphereView& view) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& point : view.on_m) sum += point.cast<double>();
  return sum / static_cast<double>(view.on_m.size());
}

TEST(LabelSphere, AFreeSphereIsFoundWithinItsNoise) {
  const auto view = look([](double, double) { return false; });
  EXPECT_LT(error_m(view), 5.0 * noise_m / std::sqrt(static_cast<double>(view.on_m.size())));
}

TEST(LabelSphere, FingersBeforeItDoNotMoveIt) {
  const auto half = look([](double x, double) { return x < 0.0; });
  EXPECT_LT(error_m(half), noise_m);
  EXPECT_GT(std::abs((centroid(half) - center).x()), 8.0 * noise_m);
  EXPECT_LT(error_m(look([](double x, double) { return std::fmod(x + 0.06, 0.025) < 0.018; })),
            noise_m);
  EXPECT_LT(error_m(look([](double, double y) { return y > -0.015; })), 2.0 * noise_m);
}

TEST(LabelSphere, WhatIsSeenLessIsKnownLess) {
  const auto known = [](const SphereView& view) {
    return fit_sphere(view, radius_m).information.trace();
  };
  EXPECT_GT(known(look([](double, double) { return false; })),
            2.0 * known(look([](double, double y) { return y > -0.01; })));
}

TEST(LabelSphere, TheRightRadiusCostsLeast) {
  const auto view = look([](double x, double) { return x < -0.005; });
  const double cost = fit_sphere(view, radius_m).cost_m2;
  EXPECT_LT(cost, fit_sphere(view, 0.9 * radius_m).cost_m2);
  EXPECT_LT(cost, fit_sphere(view, 1.1 * radius_m).cost_m2);
}

TEST(LabelSphere, OnePointIsEnoughForAnAnswer) {
  EXPECT_TRUE(fit_sphere({{}, {{0.0f, 0.0f, 1.0f}}, {}}, radius_m).center_m.allFinite());
}

}  // namespace
}  // namespace touchtrace::label
