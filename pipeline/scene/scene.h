#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"
#include "pipeline/scene/parameters.h"

namespace touchtrace::scene {

/// World frame: z up, the person stands at the origin facing -y, the camera looks along +y; metres.
inline constexpr double gravity_m_per_s2 = 9.81;

inline constexpr int finger_count = 5;  ///< index, middle, ring, little, thumb

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

struct RigidState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< world from body
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();
};

/// The scene at one instant. The hand's body frame lies in the palm: origin at its centre, z out of
/// the palm, x towards the fingertips.
struct SceneSample {
  double time_s = 0.0;                             ///< host's clock
  RigidState hand, object;                         ///< and what it holds
  std::optional<RigidState> ball;                  ///< once it is in play
  double finger_closure = 0.0;                     ///< 0 open .. 1 a fist: the mean of the fingers
  std::array<double, finger_count> flexion_rad{};  ///< of the first joint; poses each finger
  /// Of the hand on the object, world; mean since the last sample.
  Eigen::Vector3d contact_force_n = Eigen::Vector3d::Zero();
  double grip_force_n = 0.0;  ///< normal forces of all taxels added up
};

/// The state that labels and models are about: the ball's, or that of the object's tracked point.
RigidState tracked_state(const ObjectSpec& object, const SceneSample& sample);

/// What happened in one clip: samples at `sample_rate_hz`, and what the glove said of it.
struct ClipMotion {
  std::vector<SceneSample> samples;
  std::vector<Truth::Event> events;
  GloveStream glove;
  bool dropped = false;
  long clamp_hits = 0;  ///< taxels that were pressed deeper than the contact law is meant for
};

inline constexpr double sample_rate_hz = 500.0;

struct SceneOptions {
  std::string activity = "wave";
  ObjectSpec object = find_object("ball");
  double minutes = 1.0;
  double clip_s = 10.0;  ///< length of a clip; each has a new grasp
  double pause_s = 2.0;  ///< between clips; nothing is recorded
  int image_width = 320, image_height = 240;
  int board_views = 20;
  std::uint64_t seed = 1;
  int glove = 1;               ///< another number: another specimen on the same hand
  bool inertial_unit = false;  ///< on the back of the hand
  SceneParameters parameters = {};
};

/// Physics, glove and its clock for clip number `clip`, starting at `start_s`; depends on nothing
/// but its arguments, so clips may be simulated in any order on any number of threads.
ClipMotion simulate_clip(const SceneOptions& options, int clip, double start_s);

/// The glove's true clock: frame n (its `sequence`) is scanned from first_frame_s + n / rate_hz,
/// host's clock, on, and arrives `latency_s` plus an exponential jitter after its scan ended.
struct GloveClock {
  double first_frame_s = 0.0, rate_hz = 15.0;
  double latency_s = 0.0, jitter_s = 0.0;
  double lost_share = 0.0;  ///< of the frames
};
GloveClock glove_clock(const SceneOptions& options);

/// Every activity there is, for messages and --help.
std::vector<std::string> activity_names();

/// What a camera sees of the gloved hand, the forearm, the object and its ball at one instant, each
/// solid placed in the world (`body_from_shape` is then world_from_shape).
std::vector<Solid> hand_solids(const SceneSample& sample);
Solid forearm_solid(const SceneSample& sample);
std::vector<Solid> object_solids(const ObjectSpec& object, const SceneSample& sample);
std::vector<Solid> ball_solids(const ObjectSpec& object, const SceneSample& sample);
/// What is tracked of them: the ball if there is one, the part of the object that holds its tracked
/// point, or all of it where that is its middle.
std::vector<Solid> tracked_solids(const ObjectSpec& object, const SceneSample& sample);

}  // namespace touchtrace::scene
