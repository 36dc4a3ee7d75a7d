#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pipeline/scene/objects/solids.h"
#include "tests/verify/scene/ball_closed_forms.h"
#include "tests/verify/scene/setups.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

TEST(SceneSolids, DistancesAreExactInsideAndOutside) {
  const Solid can{ShapeKind::cylinder, {0.03, 0.05, 0.0}};
  EXPECT_NEAR(distance(can, {0.04, 0.0, 0.0}).value_m, 0.01, 1e-15);
  EXPECT_NEAR(distance(can, {0.0, 0.02, 0.045}).value_m, -0.005, 1e-15);
  EXPECT_NEAR(distance(can, {0.033, 0.0, 0.054}).value_m, 0.005, 1e-15);
  const Solid box{ShapeKind::box, {0.01, 0.02, 0.03}};
  EXPECT_NEAR(distance(box, {0.013, 0.024, 0.0}).value_m, 0.005, 1e-15);
  EXPECT_EQ(distance(box, {-0.009, 0.0, 0.0}).normal, Vector3d(-1, 0, 0));
  const Solid capsule{ShapeKind::capsule, {0.02, 0.05, 0.0}};
  EXPECT_NEAR(distance(capsule, {0.0, 0.0, 0.08}).value_m, 0.01, 1e-15);
}

TEST(SceneSolids, NormalsAreGradients) {
  const double eps = 1e-6;
  for (ShapeKind kind :
       {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder}) {
    ObjectSpec object;
    object.solids = {Solid{kind, {0.02, 0.03, 0.04}}};
    object.solids[0].body_from_shape = Eigen::Translation3d(0.01, 0.0, -0.01) *
                                       Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
    for (const Vector3d& p : {Vector3d(0.05, 0.02, 0.03), Vector3d(0.012, 0.004, 0.001)}) {
      Vector3d slope;
      for (int axis = 0; axis < 3; ++axis)
        slope[axis] = (distance_m(object, p + eps * Vector3d::Unit(axis)) -
                       distance_m(object, p - eps * Vector3d::Unit(axis))) /
                      (2 * eps);
      EXPECT_NEAR((slope - distance(object, p).normal).norm(), 0.0, 1e-6) << static_cast<int>(kind);
      EXPECT_DOUBLE_EQ(distance(object, p).value_m, distance_m(object, p));
    }
  }
}

TEST(ScenePhysics, MatchesClosedForms) {
  for (const auto* forms : {&closed_forms(), &ball_closed_forms()})
    for (const ClosedForm& form : *forms) {
      EXPECT_LE(form.error(form.step_s), form.max_error) << form.name;
      if (form.min_order > 0.0) {
        EXPECT_GE(order_of_convergence(convergence(form)), form.min_order) << form.name;
      }
    }
}

TEST(ScenePhysics, ClosedFormChecksFailForCoarseSteps) {
  const auto error_of_coarse_steps = [](const ClosedForm& form) {
    return form.error(20 * form.step_s);
  };
  int exceeded = 0;
  for (const ClosedForm& form : closed_forms())
    if (form.min_order > 0.0) exceeded += error_of_coarse_steps(form) > form.max_error;
  EXPECT_GE(exceeded, 3);
}

TEST(ScenePhysics, MaxErrorKeepsNan) {
  MaxError worst;
  for (const double value : {0.5, std::nan(""), 0.1}) worst.add(value);
  EXPECT_TRUE(std::isnan(worst.value));
}

TEST(ScenePhysics, RestingBlockPressesWithItsWeight) {
  for (double mass_kg : {0.005, 0.05, 0.5, 10.0})
    for (double h : {0.0005, 0.002, 0.01})
      EXPECT_NEAR(resting_force_ratio(mass_kg, h, 3.0), 1.0, 1e-3)
          << mass_kg << " kg, " << h << " s";
}

TEST(ScenePhysics, TissueStiffensExponentially) {
  const ContactParameters contact;
  for (double depth_m : {0.0002, 0.001, 0.004, 0.0075}) {
    World world(sled(0.2, 0.0), rigid_arm());
    place_above(world, sled_place_m, 0.0);
    world.object.position_m.z() -= depth_m;
    double expected_n = 0.0;
    for (const Taxel& taxel : world.model().taxels) {
      const Distance d = distance(world.spec(), taxel.position_m - world.object.position_m);
      if (taxel.finger >= 0 || d.value_m >= 0.0) continue;
      expected_n -= contact.stiffness_n_per_m3 * taxel.area_m2 * contact.hardening_m *
                    std::expm1(-d.value_m / contact.hardening_m) * d.normal.z();
    }
    world.step(hold_still(world), 1e-9);
    EXPECT_NEAR(world.force_on_object_n().z() / expected_n, 1.0, 1e-5) << depth_m;
  }
}

TEST(ScenePhysics, ExtremesStayFiniteAndGainNoEnergy) {
  for (double mass_kg : {0.005, 0.2, 10.0})
    for (double stiffness_factor : {0.01, 1.0, 100.0})
      for (double friction : {0.0, 2.0})
        for (double h : {0.0001, 0.001, 0.01}) {
          ContactParameters contact;
          contact.stiffness_n_per_m3 *= stiffness_factor;
          World world(sphere(mass_kg, friction, 0.03), rigid_arm(), contact);
          place_above(world, {0.0, 0.005, 0.0}, 0.001);
          world.object.velocity_m_per_s = {0.5, 0.0, -10.0};
          const Drive drive = hold_still(world);
          const double before = energy_j(world);
          for (double t = 0.0; t < 0.1; t += h) world.step(drive, h);
          ASSERT_TRUE(is_finite(world))
              << mass_kg << ' ' << stiffness_factor << ' ' << friction << ' ' << h;
          EXPECT_LE(energy_j(world), before + 1e-3 * std::abs(before))
              << mass_kg << ' ' << stiffness_factor << ' ' << friction << ' ' << h;
        }
}

/// A copy owns its contacts: it continues to the same bits after the original is destroyed.
TEST(ScenePhysics, CopyContinuesLikeTheOriginal) {
  auto world = std::make_unique<World>(block(0.2, 0.7, {0.03, 0.03, 0.02}), rigid_arm());
  place_above(*world, Vector3d::Zero(), 1e-6);
  const Drive drive = hold_still(*world);
  run(*world, drive, 0.1, 0.002);
  ASSERT_TRUE(world->contact().touching());
  World copy = *world;
  run(*world, drive, 0.1, 0.002);
  const RigidState other = world->object;
  world.reset();
  run(copy, drive, 0.1, 0.002);
  EXPECT_TRUE(copy.contact().touching());
  EXPECT_EQ(copy.object.position_m, other.position_m);
  EXPECT_EQ(copy.object.velocity_m_per_s, other.velocity_m_per_s);
}

TEST(ScenePhysics, TooDeepContactsAreCounted) {
  World world(sphere(10.0, 0.5, 0.03), rigid_arm());
  place_above(world, Vector3d::Zero(), 0.0);
  world.object.velocity_m_per_s.z() = -5.0;
  const Drive drive = hold_still(world);
  for (int i = 0; i < 20; ++i) world.step(drive, 0.001);
  EXPECT_GT(world.contact().num_clamped(), 0);
}

TEST(ScenePhysics, ArmForceIsLimited) {
  World world(sphere(0.1, 0.5, 0.03));
  world.object.position_m.z() = 50.0;
  Drive drive = hold_still(world);
  drive.position_m.x() = 10.0;  // demands 3 kN
  world.step(drive, 0.001);
  const ArmParameters arm;
  EXPECT_NEAR(world.hand.velocity_m_per_s.x(), 0.001 * arm.max_force_n / arm.mass_kg, 1e-12);
}

}  // namespace
}  // namespace touchtrace::scene
