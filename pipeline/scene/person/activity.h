#pragma once

#include <functional>
#include <memory>

#include "pipeline/scene/base/motion.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Activity time until which the other hand keeps a tool from tipping over.
inline constexpr double steadied_until_s = -0.7;

/// Place on the palm where an object is grasped, from the palm's centre towards the fingertips.
inline constexpr double grasp_center_m = 0.018;

/// The person's command at one instant.
struct Command {
  MotionState hand;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< world from hand
  bool closed_grip = true;    ///< force-controlled fingers, else posture
  double grip_force_n = 0.0;  ///< of the four fingers together
  std::array<double, num_fingers> posture_rad{};
  bool carrying = true;  ///< whether the object's weight is fed forward
};

/// Grip force against slipping and turning under a load of `load_m_per_s2`, the object's
/// acceleration minus gravity. Palm and fingers both contribute friction; an object held away from
/// its centre of mass also needs grip against turning.
double load_grip_n(const WaveParameters& grip, const ObjectSpec& object,
                   const Eigen::Vector3d& load_m_per_s2);
/// Whether the object is in the hand after it was put on the palm.
bool is_in_hand(const ObjectSpec& object, const SceneSample& seen);
/// Whether the object has fallen from the hand.
bool has_fallen(const SceneSample& seen);

/// Inputs of an activity at the start of a clip.
struct ActivityStart {
  const ObjectSpec& object;
  RandomStream random;                ///< of this activity alone
  const SceneParameters& parameters;  ///< need not outlive the start
};

/// Motion planning and control of the person. One file and one row of activities() each.
class Activity {
 public:
  virtual ~Activity() = default;
  /// Called every control interval in order of time. Time 0 is the start of the clip, earlier times
  /// are the grasp. `seen` is the state of the scene at that time.
  virtual Command command(double time_s, const SceneSample& seen) = 0;
  /// Initial state of the ball at time 0, for activities with a ball.
  virtual std::optional<RigidState> serve(const SceneSample&) { return std::nullopt; }
  /// Whether the object was dropped or the ball missed, which ends the clip.
  virtual bool is_lost(const SceneSample& seen) const { return has_fallen(seen); }
};

struct ActivityRow {
  std::string name, summary, default_object;
  double step_s;  ///< physics' step in contact; its error: `touchtrace-verify scene`
  bool (*accepts)(const ObjectSpec& object);
  std::unique_ptr<Activity> (*make)(ActivityStart start);
  /// Distance from the person and downward pitch with which the camera sees everything.
  double camera_distance_m = 1.3, camera_pitch_deg = 8.0;
};
const std::vector<ActivityRow>& activities();
std::vector<std::string> activity_names();
/// Throws usage_error with the known names.
const ActivityRow& find_activity(const std::string& name);
/// Object of the activity if no other is given.
const ObjectSpec& default_object(const std::string& activity);
/// Throws usage_error, naming the accepted objects, unless the activity accepts the object.
void require_compatible(const ActivityRow& activity, const ObjectSpec& object);

std::unique_ptr<Activity> make_wave(ActivityStart start);
std::unique_ptr<Activity> make_throw(ActivityStart start);
std::unique_ptr<Activity> make_pingpong(ActivityStart start);
std::unique_ptr<Activity> make_balance(ActivityStart start);

/// Orientation of a hand before the person with the palm up and the fingers pointing away, rotated
/// by roll about the forearm, pitch about the wrist and yaw about the vertical.
Eigen::Quaterniond palm_up(double roll_rad, double pitch_rad, double yaw_rad);

}  // namespace touchtrace::scene
