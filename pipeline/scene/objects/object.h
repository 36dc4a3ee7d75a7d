#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace::scene {

enum class ShapeKind { sphere, box, capsule, cylinder };

/// A solid that physics touches and the camera sees. `size_m`: sphere {r}; box half extents;
/// capsule and cylinder {radius, half length, -} along the body's z axis. `body_from_shape` places
/// it in its body.
struct Solid {
  ShapeKind kind = ShapeKind::sphere;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Eigen::Isometry3d body_from_shape = Eigen::Isometry3d::Identity();
  Eigen::Vector3d color = Eigen::Vector3d::Constant(0.5);  ///< linear RGB in 0..1
};

/// What a model may be shown of an object: trained on, kept for tests inside of the range of mass
/// and shape that is trained on, or far outside of that range and reported apart. A tool belongs to
/// one activity, whose only object it is.
enum class ObjectRole { seen, unseen, outside, tool };
std::string role_name(ObjectRole role);

/// How an object lies in the hand; body frame.
struct Hold {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();    ///< over the middle of the palm
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();     ///< towards the little finger
  Eigen::Vector3d from_palm = Eigen::Vector3d::UnitZ();  ///< out of the palm
  /// How every grasp differs: not, about `across`, by right angles, at will.
  enum class Turns { none, axis, faces, any } turns = Turns::none;
};

/// What is bounced on an object: a thin hollow sphere, a second body that nothing holds.
struct Ball {
  double radius_m = 0.02, mass_kg = 0.0027, drag_coefficient = 0.45;
  double restitution = 0.8, friction = 0.6;           ///< against the object
  Eigen::Vector3d meets_m = Eigen::Vector3d::Zero();  ///< the middle of the object's face
  Eigen::Vector3d color = Eigen::Vector3d::Constant(0.9);
};

/// An object that a hand holds; the origin of its body frame is its centre of mass. Its state, the
/// one that is labelled and predicted, is that of its ball if it has one, otherwise that of the
/// point `tracked_m` of its body.
struct ObjectSpec {
  std::string name;
  double mass_kg = 0.1, friction = 0.7;
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Identity();
  std::vector<Solid> solids;
  std::string summary = {};
  ObjectRole role = ObjectRole::seen;
  bool inertia_given = false;  ///< mass and inertia as its file says; otherwise those of its solids
  Hold hold = {};
  std::optional<std::array<double, 2>> toss_apex_m = std::nullopt;  ///< none: never thrown
  Eigen::Vector3d tracked_m = Eigen::Vector3d::Zero();
  std::optional<Ball> ball = std::nullopt;
};

/// The objects that come with the program, seen ones first, tools last.
const std::vector<ObjectSpec>& objects();
/// Throws usage_error with the known names.
const ObjectSpec& find_object(const std::string& name);

}  // namespace touchtrace::scene
