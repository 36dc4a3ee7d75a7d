#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"
#include "pipeline/scene/base/parameters.h"
#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

/// World frame: z up, the person stands at the origin facing -y, the camera looks along +y; metres.
inline constexpr double gravity_m_per_s2 = 9.81;

inline constexpr int finger_count = 5;  ///< index, middle, ring, little, thumb

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
  bool object_fell = false;
  long clamp_hits = 0;  ///< taxels that were pressed deeper than the contact law is meant for
};

inline constexpr double sample_rate_hz = 500.0;
/// What moves the hand thinks on this grid, whatever the physics' step.
inline constexpr double control_interval_s = 1.0 / sample_rate_hz;

struct SceneOptions {
  std::string activity = "wave";
  ObjectSpec object = find_object("ball");
  double minutes = 1.0;
  double clip_s = 10.0;      ///< mean length of a clip; each has a new grasp
  double clip_spread = 0.2;  ///< clips are longer or shorter by this share at most
  double pause_s = 2.0;      ///< after the longest of clips; nothing is recorded
  int image_width = 320, image_height = 240;
  int board_views = 20;
  std::uint64_t seed = 1;
  int glove = 1;               ///< another number: another specimen on the same hand
  bool inertial_unit = false;  ///< on the back of the hand
  SceneParameters parameters = {};
};

}  // namespace touchtrace::scene
