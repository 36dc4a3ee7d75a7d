#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace::scene {

enum class ShapeKind { sphere, box, capsule, cylinder };

/// A primitive shape of an object or of the hand, for contact and rendering.
struct Solid {
  ShapeKind kind = ShapeKind::sphere;
  /// Sphere: {radius}; box: half extents; capsule and cylinder: {radius, half length} along z.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Eigen::Isometry3d body_from_shape = Eigen::Isometry3d::Identity();
  Eigen::Vector3d color = Eigen::Vector3d::Constant(0.5);  ///< linear RGB in 0..1
};

/// Split of the objects for training and testing.
enum class ObjectRole {
  seen,     ///< for training
  unseen,   ///< for tests, in the range of mass and shape of the seen objects
  outside,  ///< for tests, far outside of that range; reported separately
  tool      ///< the only object of one activity
};
std::string role_name(ObjectRole role);

/// How an object is held; vectors in its body frame.
struct Hold {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();    ///< point over the palm's centre
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();     ///< direction towards the little finger
  Eigen::Vector3d from_palm = Eigen::Vector3d::UnitZ();  ///< direction out of the palm
  /// Random rotation of a grasp: none, about `across`, by right angles, or any.
  enum class Turns { none, axis, faces, any } turns = Turns::none;
};

/// A thin hollow sphere that is bounced on an object: a second, free body.
struct Ball {
  double radius_m = 0.02, mass_kg = 0.0027, drag_coefficient = 0.45;
  double restitution = 0.8, friction = 0.6;  ///< against the object
  Eigen::Vector3d face_center_m =
      Eigen::Vector3d::Zero();  ///< centre of the object's face that hits the ball
  Eigen::Vector3d color = Eigen::Vector3d::Constant(0.9);
};

/// An object that a hand holds. The origin of its body frame is its centre of mass. Labels and
/// models use the state of its ball, if it has one, otherwise of its body's point `tracked_m`.
struct ObjectSpec {
  std::string name;
  double mass_kg = 0.1, friction = 0.7;
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Identity();
  std::vector<Solid> solids;
  std::string summary = {};
  ObjectRole role = ObjectRole::seen;
  bool inertia_given = false;  ///< mass properties from the file's [body], not from the solids
  Hold hold = {};
  std::optional<std::array<double, 2>> toss_apex_m = std::nullopt;  ///< none: never thrown
  Eigen::Vector3d tracked_m = Eigen::Vector3d::Zero();
  std::optional<Ball> ball = std::nullopt;
};

/// Built-in objects by role: seen, unseen, outside, tools.
const std::vector<ObjectSpec>& objects();
/// Throws usage_error with the known names.
const ObjectSpec& find_object(const std::string& name);

}  // namespace touchtrace::scene
