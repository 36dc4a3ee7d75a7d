#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/scene/objects/sin_cos.h"
#include "pipeline/scene/objects/solids.h"
#include "pipeline/scene/physics/contact_sums.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

Vector3d random_vector(RandomStream& random, double size) {
  return size * Vector3d(random.normal(), random.normal(), random.normal());
}

TEST(SceneLanes, SinCosIsAccurateTo3e16) {
  RandomStream random(1, "angles");
  for (double size : {1e-3, 1.0, 30.0, 1e5})
    for (int i = 0; i < 10000; ++i) {
      const Lanes angle{random.uniform(-size, size), random.uniform(-size, size)};
      const SinCos found = sin_cos(angle);
      for (int lane = 0; lane < num_lanes; ++lane) {
        EXPECT_NEAR(found.sine[lane], std::sin(angle[lane]), 3e-16) << angle[lane];
        EXPECT_NEAR(found.cosine[lane], std::cos(angle[lane]), 3e-16) << angle[lane];
      }
    }
}

TEST(SceneSolids, LanesAreIndependent) {
  RandomStream random(1, "points");
  for (const ObjectSpec& object : objects())
    for (const Solid& solid : object.solids) {
      const Vector3d a = random_vector(random, 0.03), b = random_vector(random, 0.03);
      Lanes3 both;
      both.set(0, a), both.set(1, b);
      EXPECT_EQ(distance_m(solid, both)[0], distance(solid, a).value_m) << object.name;
      EXPECT_EQ(distance_m(solid, both)[1], distance(solid, b).value_m) << object.name;
      EXPECT_EQ(normal(solid, both).at(0), distance(solid, a).normal) << object.name;
      EXPECT_EQ(normal(solid, both).at(1), distance(solid, b).normal) << object.name;
    }
}

TEST(SceneSolids, NormalAtTheCentreIsAUnitVector) {
  for (ShapeKind kind :
       {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder})
    EXPECT_EQ(distance(Solid{kind, {0.02, 0.03, 0.04}}, Vector3d::Zero()).normal.norm(), 1.0)
        << static_cast<int>(kind);
}

/// Reference: the force law of ContactSums::add(), contact by contact.
TEST(SceneContact, SumsEqualThoseOfSingleContacts) {
  RandomStream random(1, "contacts");
  const Twist twist{random_vector(random, 0.3), random_vector(random, 2.0)};
  ContactSums sums;
  Vector6d expected = Vector6d::Zero();
  for (int i = 0; i < 10; ++i) {
    Lanes3 place, normal, tangent;
    Lanes push{}, extra{}, isotropic{};
    for (int lane = 0; lane < num_lanes; ++lane) {
      const Vector3d p = random_vector(random, 0.05), n = random_vector(random, 1.0).normalized(),
                     t = random_vector(random, 1.0);
      place.set(lane, p), normal.set(lane, n), tangent.set(lane, t);
      push[lane] = random.normal(), extra[lane] = random.uniform(),
      isotropic[lane] = random.uniform();
      const Vector3d v = twist.at(p);
      const Vector3d force = push[lane] * n + t - extra[lane] * n * n.dot(v) - isotropic[lane] * v;
      expected += stack({force, p.cross(force)});
    }
    sums.add(place, normal, push, tangent, extra, isotropic);
  }
  const Vector6d found = sums.bias() - sums.resistance() * stack(twist);
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_EQ(sums.resistance(), sums.resistance().transpose());
}

HandInObject random_hand(RandomStream& random) {
  HandInObject hand;
  hand.object_from_hand =
      Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
          .normalized()
          .toRotationMatrix();
  hand.origin_m = random_vector(random, 0.05);
  for (double& flexion : hand.flexion_rad) flexion = random.uniform(0.0, max_flexion_rad);
  return hand;
}

struct PlacedTaxel {
  Vector3d point_m, flexion_step_m;  ///< flexion_step_m: displacement by a small flexion
};

PlacedTaxel placed(const Taxel& taxel, const HandInObject& hand, double radians) {
  const auto at = [&](double more_rad) -> Vector3d {
    if (taxel.finger < 0) return hand.origin_m + hand.object_from_hand * taxel.position_m;
    const FingerPose pose =
        pose_finger(hand_model().fingers[taxel.finger], hand.flexion_rad[taxel.finger] + more_rad);
    return hand.origin_m +
           hand.object_from_hand *
               (pose.joint_m[taxel.link] + pose.hand_from_link[taxel.link] * taxel.position_m);
  };
  return {at(0.0), at(0.5 * radians) - at(-0.5 * radians)};
}

/// Reference: the distances of all taxels. Includes objects of several solids.
TEST(SceneContact, SearchFindsEveryTaxelThatTouches) {
  constexpr double margin_m = 0.001, radians = 1e-4;
  RandomStream random(1, "hands");
  std::size_t found = 0;
  for (const ObjectSpec& object : objects()) {
    ContactSearch search(hand_model());
    for (int i = 0; i < 20; ++i) {
      const HandInObject hand = random_hand(random);
      std::vector<bool> touches(hand_model().taxels.size(), false);
      for (const LinkContacts& link : search.find(object, hand, margin_m))
        for (const TaxelContact& contact : search.contacts(link)) {
          touches[contact.taxel] = true, ++found;
          const PlacedTaxel taxel = placed(hand_model().taxels[contact.taxel], hand, radians);
          const Distance d = distance(object, contact.point_m);
          EXPECT_LE((contact.point_m - taxel.point_m).norm(), 1e-15);
          EXPECT_LE(
              (radians * link.flexion_twist.at(contact.point_m) - taxel.flexion_step_m).norm(),
              1e-3 * radians * 0.2);
          EXPECT_EQ(contact.depth_m, -d.value_m);
          EXPECT_EQ(contact.normal, d.normal);
        }
      for (std::size_t t = 0; t < touches.size(); ++t)
        EXPECT_EQ(touches[t],
                  distance_m(object, placed(hand_model().taxels[t], hand, 0.0).point_m) < margin_m)
            << object.name << ", taxel " << t;
    }
  }
  EXPECT_GT(found, 1000u);
}

}  // namespace
}  // namespace touchtrace::scene
