#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <fstream>
#include <set>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "pipeline/scene/objects/mass.h"
#include "pipeline/scene/objects/object_file.h"
#include "pipeline/scene/objects/object_texts.h"
#include "pipeline/scene/objects/solids.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::string plain_ball = R"(
summary = "a ball"
role = "seen"
friction = 0.7
[[solid]]
shape = "sphere"
radius_m = 0.03
mass_kg = 0.2
color = [1, 0, 0]
)";

/// `plain_ball` with [body] instead of the solid's mass.
std::string with_body(const std::string& body) {
  std::string text = plain_ball;
  text.erase(text.find("mass_kg"), std::string("mass_kg = 0.2\n").size());
  return text + "[body]\nmass_kg = 0.2\ncenter_m = [0, 0, 0]\n" + body;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

ObjectSpec parsed(const std::string& text) { return parse_object("test", text, "test.toml"); }

void expect_rejected(const std::string& text, const std::string& reason = "") {
  testing::expect_error([&] { parsed(text); }, reason);
}

/// Mass properties at 1 kg/m^3 by summation over a grid of `cells`^3 points.
MassProperties grid_sum(const Solid& solid, double wall_m, double half_m, int cells) {
  const double step = 2 * half_m / cells, piece = step * step * step;
  MassProperties sum;
  for (int i = 0; i < cells * cells * cells; ++i) {
    const Vector3d cell(i % cells, i / cells % cells, i / cells / cells);
    const Vector3d p = (cell + Vector3d::Constant(0.5)) * step - Vector3d::Constant(half_m);
    const double d = distance(solid, p).value_m;
    if (d > 0.0 || (wall_m > 0.0 && d < -wall_m)) continue;
    sum.mass_kg += piece;
    sum.center_m += piece * p;
    sum.inertia_kg_m2 += piece * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
  }
  sum.center_m /= sum.mass_kg;
  const Vector3d& c = sum.center_m;
  sum.inertia_kg_m2 -= sum.mass_kg * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  return sum;
}

TEST(SceneObjects, MassPropertiesAreIntegralsOverTheSolid) {
  for (ShapeKind kind :
       {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder})
    for (double wall_m : {0.0, 0.1}) {
      Solid solid{kind, {0.3, 0.4, 0.25}};
      solid.body_from_shape = Eigen::Translation3d(0.05, -0.02, 0.03) *
                              Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
      const MassProperties exact = volume_properties(solid, wall_m);
      const MassProperties sum = grid_sum(solid, wall_m, 0.8, 160);
      // Cells of 1 cm at the surface count entirely or not at all, so errors have both signs: about
      // v sqrt(N / 12) for N = 2e4 cut cells of volume v = 1e-6 m^3, which is 4e-4 of 0.1 m^3. The
      // bounds are 5 times that for the volume, 12 times for moments, where distant cells weigh
      // more.
      EXPECT_NEAR(sum.mass_kg / exact.mass_kg, 1.0, 2e-3) << static_cast<int>(kind);
      EXPECT_LT((sum.center_m - exact.center_m).norm(), 1e-3);
      EXPECT_LT((sum.inertia_kg_m2 - exact.inertia_kg_m2).norm() / exact.inertia_kg_m2.norm(), 5e-3)
          << static_cast<int>(kind) << ' ' << wall_m;
    }
}

TEST(SceneObjects, CombinedBodiesFollowTheParallelAxisTheorem) {
  const MassProperties point{1.0, {0.1, 0.0, 0.0}, Matrix3d::Zero()};
  const MassProperties other{3.0, {-0.1, 0.0, 0.0}, Matrix3d::Zero()};
  const MassProperties both = combined({point, other});
  EXPECT_DOUBLE_EQ(both.mass_kg, 4.0);
  EXPECT_NEAR(both.center_m.x(), -0.05, 1e-15);
  EXPECT_NEAR(both.inertia_kg_m2(1, 1), 0.75 * 0.04, 1e-15);  // reduced mass x distance^2
  EXPECT_NEAR(both.inertia_kg_m2(0, 0), 0.0, 1e-15);
}

TEST(SceneObjects, HaveTwelveSeenThreeUnseenOneOutside) {
  std::map<ObjectRole, int> count;
  std::set<std::string> names;
  double lightest = 1e9, heaviest = 0.0;
  for (const ObjectSpec& object : objects()) {
    ++count[object.role];
    names.insert(object.name);
    if (object.role != ObjectRole::seen) continue;
    lightest = std::min(lightest, object.mass_kg);
    heaviest = std::max(heaviest, object.mass_kg);
  }
  EXPECT_EQ(count[ObjectRole::seen], 12);
  EXPECT_EQ(count[ObjectRole::unseen], 3);
  EXPECT_EQ(count[ObjectRole::outside], 1);
  EXPECT_EQ(names.size(), objects().size());
  EXPECT_NEAR(lightest, 0.005, 0.0003);
  EXPECT_NEAR(heaviest, 1.0, 1e-9);
  for (const ObjectSpec& object : objects()) {
    const bool within = object.mass_kg >= lightest && object.mass_kg <= heaviest;
    EXPECT_EQ(within, object.role != ObjectRole::outside) << object.name;
  }
  for (const char* name : {"ball", "box", "can", "bottle"}) EXPECT_TRUE(names.contains(name));
}

TEST(SceneObjects, TrackedPointIsRelativeToTheCentreOfMass) {
  const std::string off_centre = replaced(plain_ball, "mass_kg", "center_m = [0, 0, 0.1]\nmass_kg");
  EXPECT_EQ(parsed(off_centre).tracked_m, Vector3d::Zero());
  EXPECT_LT(
      (parsed("tracked_m = [0, 0, 0.4]\n" + off_centre).tracked_m - Vector3d(0, 0, 0.3)).norm(),
      1e-12);
  std::string ball =
      "[ball]\nradius_m = 0.02\nmass_kg = 0.003\ndrag_coefficient = 0.4\n"
      "restitution = 0.8\nfriction = 0.5\nface_center_m = [0, 0, 0.3]\n"
      "color = [1, 1, 1]\n";
  EXPECT_EQ(parsed(off_centre + ball).ball->mass_kg, 0.003);
  EXPECT_NEAR(parsed(off_centre + ball).ball->face_center_m.z(), 0.2, 1e-12);
  expect_rejected("tracked_m = [0, 0, 0.4]\n" + off_centre + ball);
  ball = replaced(ball, "face_center_m", "meets_m");  // former name
  EXPECT_NEAR(parsed(off_centre + ball).ball->face_center_m.z(), 0.2, 1e-12);
}

TEST(SceneObjects, MassPropertiesArePhysical) {
  for (const ObjectSpec& object : objects()) {
    const Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(object.inertia_kg_m2).eigenvalues();
    EXPECT_GT(moments[0], 0.0) << object.name;
    EXPECT_GE(moments[0] + moments[1], moments[2] * (1 - 1e-9)) << object.name;
    EXPECT_LT(distance_m(object, Vector3d::Zero()), 0.02) << object.name;  // centre of mass
    EXPECT_LT(distance_m(object, object.hold.center_m), 0.0) << object.name;
    EXPECT_NEAR(object.hold.across.dot(object.hold.from_palm), 0.0, 1e-12) << object.name;
  }
}

TEST(SceneObjects, ContentsChangeMassButNotShape) {
  const ObjectSpec &full = find_object("bottle"), &half = find_object("bottle-half"),
                   &empty = find_object("bottle-empty");
  EXPECT_LT(empty.mass_kg, 0.5 * half.mass_kg);
  EXPECT_LT(half.mass_kg, 0.6 * full.mass_kg);
  EXPECT_EQ(full.solids.front().size_m, half.solids.front().size_m);
  EXPECT_EQ(full.solids.front().color, empty.solids.front().color);
  EXPECT_GT(half.solids.front().body_from_shape.translation().norm(), 0.01);  // bottom-heavy
}

TEST(SceneObjects, GivenBodyReplacesComputedMassProperties) {
  const ObjectSpec object = parsed(with_body("inertia_kg_m2 = [8e-5, 7e-5, 6e-5, 1e-6, 0, 0]\n"));
  EXPECT_TRUE(object.inertia_given);
  EXPECT_EQ(object.inertia_kg_m2(0, 1), 1e-6);
  EXPECT_FALSE(parsed(plain_ball).inertia_given);
}

TEST(SceneObjects, RejectsInvalidFiles) {
  expect_rejected("", "summary is missing");
  expect_rejected("summary = [", "test.toml:1");
  expect_rejected(replaced(plain_ball, "0.7", "-0.7"), "friction is -0.7");
  expect_rejected(replaced(plain_ball, "0.7", "nan"), "friction is nan");
  expect_rejected(replaced(plain_ball, "0.7", "\"high\""), "friction is not a number");
  expect_rejected(replaced(plain_ball, "0.2", "-1"), "mass_kg is -1");
  expect_rejected(replaced(plain_ball, "0.2", "1e30"), "mass_kg is 1e+30");
  expect_rejected(replaced(plain_ball, "0.2", "inf"), "mass_kg is inf");
  expect_rejected(replaced(plain_ball, "0.2", "1e-5"), "mass is 1e-05 kg in total");
  expect_rejected(replaced(plain_ball, "0.03", "50"), "radius_m is 50");
  expect_rejected(replaced(plain_ball, "sphere", "cone"), "shape is not one of sphere, box");
  expect_rejected(replaced(plain_ball, "seen", "hidden"), "role is not one of");
  expect_rejected(replaced(plain_ball, "friction", "fricton"), "friction is missing");
  expect_rejected(plain_ball + "weight = 3\n", "unknown key 'weight'");
  expect_rejected("weight = 3\n" + plain_ball, "unknown key 'weight'");
  expect_rejected("weight = 3\nsize = 1\n" + plain_ball, "unknown keys 'size', 'weight'");
  expect_rejected(plain_ball + "wall_m = 0.03\n", "wall_m is 0.03");
  expect_rejected(plain_ball + "axis = [0, 0, 0]\n", "axis has no direction");
  expect_rejected(plain_ball + "center_m = [0, 0]\n", "center_m does not hold 3 numbers");
  expect_rejected(plain_ball + "[hold]\nacross = [0, 0, 1]\n", "from_palm is parallel to `across`");
  expect_rejected("toss_apex_m = [0.3, 0.1]\n" + plain_ball, "toss_apex_m is not [low, high]");
  expect_rejected(with_body("inertia_kg_m2 = [1e-5, 1e-5, 3e-5, 0, 0, 0]\n"),
                  "triangle inequality");
  expect_rejected(with_body("inertia_kg_m2 = [1e-5, 1e-5, -1e-5, 0, 0, 0]\n"), "positive definite");
  expect_rejected(with_body("inertia_kg_m2 = [1, 1, 1, 0, 0, 0]\n"), "farthest point");
  expect_rejected(with_body("inertia_kg_m2 = [1e-12, 1e-12, 1e-12, 0, 0, 0]\n"), "thinner than");
  expect_rejected(with_body("inertia_kg_m2 = [1e-5, 1e-5]\n"), "does not hold 6 numbers");
  expect_rejected(replaced(with_body("inertia_kg_m2 = [8e-5, 8e-5, 8e-5, 0, 0, 0]\n"),
                           "[0, 0, 0]\ni", "[0.5, 0, 0]\ni"),
                  "outside of the solids");
}

TEST(SceneObjects, NameOfTheObjectIsThatOfItsFile) {
  const touchtrace::testing::TemporaryFolder folder;
  std::ofstream(folder / "my_ball.toml") << plain_ball;
  std::ofstream(folder / "My Ball.toml") << plain_ball;
  EXPECT_EQ(load_object((folder / "my_ball.toml").string()).name, "my_ball");
  EXPECT_THROW(load_object((folder / "My Ball.toml").string()), Error);
  EXPECT_THROW(load_object((folder / "none.toml").string()), Error);
  EXPECT_EQ(load_object("can").name, "can");
}

/// Real files with bytes changed, removed and duplicated at random.
TEST(SceneObjects, DamagedFilesAreParsedOrRejected) {
  RandomStream random(1, "damaged objects");
  int num_rejected = 0;
  for (int i = 0; i < 4000; ++i) {
    auto file = object_texts().begin();
    std::advance(file, static_cast<long>(random.below(object_texts().size())));
    std::string text(file->second);
    for (std::uint64_t n = 1 + random.below(4); n > 0; --n) {
      const auto at = static_cast<std::size_t>(random.below(text.size()));
      const auto count = static_cast<std::size_t>(random.below(12));
      switch (random.below(3)) {
        case 0:
          text[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          text.erase(at, count);
          break;
        default:
          text.insert(at, text.substr(static_cast<std::size_t>(random.below(text.size())), count));
      }
    }
    try {
      EXPECT_TRUE(parsed(text).inertia_kg_m2.allFinite());
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data);
      ++num_rejected;
    }
  }
  EXPECT_GT(num_rejected, 1000);
}

TEST(SceneObjects, RejectsDeepNesting) {
  expect_rejected("a = " + std::string(30000, '['));
  expect_rejected("a = " + std::string(10000, '[') + std::string(10000, ']'));
}

}  // namespace
}  // namespace touchtrace::scene
