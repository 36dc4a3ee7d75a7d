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

// World frame, in metres: z up, the person stands at the origin facing -y, the camera looks along
// +y.

inline constexpr double gravity_m_per_s2 = 9.81;

inline constexpr int num_fingers = 5;  ///< index, middle, ring, little, thumb

struct RigidState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< world from body
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();  ///< world frame
};

/// State of the scene at one instant. The hand's body frame has its origin at the palm's centre, z
/// out of the palm and x towards the fingertips.
struct SceneSample {
  double time_s = 0.0;  ///< host clock
  RigidState hand, object;
  std::optional<RigidState> ball;                 ///< once it is in play
  std::array<double, num_fingers> flexion_rad{};  ///< of each first joint, which drives the others
  /// Force of the hand on the object, world frame; mean since the last sample.
  Eigen::Vector3d contact_force_n = Eigen::Vector3d::Zero();
  double grip_force_n = 0.0;  ///< sum of the normal forces of all taxels
};

/// State that labels and models use: the ball's, or that of the object's tracked point.
RigidState tracked_state(const ObjectSpec& object, const SceneSample& sample);

/// One simulated clip.
struct ClipMotion {
  std::vector<SceneSample> samples;  ///< at sample_rate_hz
  std::vector<Truth::Event> events;
  GloveStream glove;
  bool object_fell = false;
  long num_clamped = 0;  ///< contacts deeper than ContactParameters::max_depth_m, all steps
};

inline constexpr double sample_rate_hz = 500.0;
/// Time between two commands of the person, independent of the physics' step size.
inline constexpr double control_interval_s = 1.0 / sample_rate_hz;

struct SceneOptions {
  std::string activity = "wave";
  ObjectSpec object = find_object("ball");
  double minutes = 1.0;
  double clip_s = 10.0;      ///< mean length of a clip; each begins with a new grasp
  double clip_spread = 0.2;  ///< largest relative deviation of a clip's length
  double pause_s = 2.0;      ///< unrecorded time after the longest possible clip
  int image_width = 320, image_height = 240;
  int board_views = 20;
  std::uint64_t seed = 1;
  int glove = 1;               ///< number of the glove instance; the hand is the same
  bool inertial_unit = false;  ///< on the back of the hand
  SceneParameters parameters = {};
  std::string sensed = "touch";  ///< what the glove's frames hold, see simulate/oracle.h
};

}  // namespace touchtrace::scene
