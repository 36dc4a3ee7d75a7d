#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "pipeline/label/estimate/body_residuals.h"

namespace touchtrace::label::residuals {
namespace {

using Eigen::Vector3d;

constexpr Core cores[] = {Core::box, Core::cylinder};
/// Where a face ends and an edge of 10 mm or more begins, a step of 1e-5 of 50 mm turns the normal
/// by 5e-5.
constexpr double tolerance = 1e-4;

/// Compares analytic derivatives with numerical ones at random shapes and poses near 0.6 m.
class Derivatives {
 public:
  explicit Derivatives(std::uint64_t seed) : random_(seed, "derivatives") {
    rotation_ = Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized();
    position_m_ = Vector3d(0.0, 0.0, 0.6) + 0.05 * direction();
    for (double& size : shape_) size = random_.uniform(0.01, 0.05);
  }

  Vector3d direction() { return Vector3d(normal(), normal(), normal()).normalized(); }
  /// Camera frame, a little inside or outside of the surface.
  Vector3d point_near_surface(Core core) {
    const Vector3d inside = 0.05 * direction();
    const auto surface = surface_distance(body_of(core, shape_.data()), inside);
    const double off_m = random_.uniform(-0.004, 0.004) - surface.distance_m;
    return rotation_ * (inside + off_m * surface.outward) + position_m_;
  }
  /// Value, if the derivatives agree.
  double check(const BodyResidual& residual) {
    static const ceres::EigenQuaternionManifold quaternion;
    const std::vector<const ceres::Manifold*> manifolds{nullptr, &quaternion, nullptr};
    ceres::NumericDiffOptions options;
    options.ridders_relative_initial_step_size = 1e-5;  // seldom across an edge
    const ceres::GradientChecker checker(&residual, &manifolds, options);
    const double* parameters[] = {shape_.data(), rotation_.coeffs().data(), position_m_.data()};
    ceres::GradientChecker::ProbeResults results;
    EXPECT_TRUE(checker.Probe(parameters, tolerance, &results)) << results.error_log;
    return results.residuals[0];
  }

 private:
  double normal() { return random_.normal(); }

  RandomStream random_;
  Shape shape_;
  Eigen::Quaterniond rotation_;
  Vector3d position_m_;
};

TEST(BodyResiduals, DerivativesOfPointDistances) {
  BodyView view;  // with weight 1, which is not differentiated
  for (const Core core : cores)
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      Derivatives at(seed);
      EXPECT_LT(std::abs(at.check(PointDistance(view, core, at.point_near_surface(core)))), 0.05);
    }
}

TEST(BodyResiduals, DerivativesOfPlaneDistances) {
  BoxPlanes planes;
  planes.sigma_ratio = 0.5;
  for (const Core core : cores)
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      Derivatives at(seed);
      at.check(PlaneDistance(planes, core, at.direction()));
    }
}

TEST(BodyResiduals, RaysThatMissHaveNoDerivatives) {
  for (const Core core : cores) {
    Derivatives at(1);
    EXPECT_EQ(at.check(RayDepth(core, Vector3d::Zero(), Vector3d(0.5, 0.0, 0.6))), 0.0);
  }
}

/// The deepest point is bisected to 0.1 mm along the ray, so that over an edge radius of 10 mm its
/// normal errs by 0.01.
TEST(BodyResiduals, DerivativesOfRaysThatEnter) {
  constexpr double step_m = 5e-4, tolerance_of_normal = 0.01;
  const RayDepth ray(Core::box, Vector3d(0.0, 0.0, 0.0), Vector3d(0.23, 0.0, 0.8));
  const Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  // the ray enters the edge that is parallel to y
  const std::array<double, 7> at{0.02, 0.03, 0.02, 0.01, 0.14, 0.0, 0.6};
  const auto evaluate = [&](const std::array<double, 7>& values, double** jacobians) {
    const double* parameters[] = {values.data(), rotation.coeffs().data(), values.data() + 4};
    double depth_m = 0.0;
    ray.Evaluate(parameters, &depth_m, jacobians);
    return depth_m;
  };
  std::array<double, 7> derivatives{};
  double* jacobians[] = {derivatives.data(), nullptr, derivatives.data() + 4};
  ASSERT_LT(evaluate(at, jacobians), -0.002);
  for (std::size_t i = 0; i < at.size(); ++i) {
    auto more = at, less = at;
    more[i] += step_m, less[i] -= step_m;
    EXPECT_NEAR(derivatives[i],
                (evaluate(more, nullptr) - evaluate(less, nullptr)) / (2.0 * step_m),
                2.0 * tolerance_of_normal)
        << i;
  }
}

}  // namespace
}  // namespace touchtrace::label::residuals
