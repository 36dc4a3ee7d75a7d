#pragma once

#include <functional>
#include <memory>

#include "pipeline/scene/base/motion.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// In the activity's time: until then the other hand keeps a tool from tipping over.
inline constexpr double steadied_until_s = -0.7;

/// Where on the palm an object is taken, from its centre towards the fingertips.
inline constexpr double grasp_middle_m = 0.018;

/// What the person wants at one instant.
struct Command {
  MotionState hand;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< world from hand
  bool closed_grip = true;    ///< fingers by force; otherwise by posture
  double grip_force_n = 0.0;  ///< of the four fingers together
  std::array<double, finger_count> posture_rad{};
  bool carrying = true;  ///< whether the object's weight is fed forward
};

/// What the fingers add so that an object neither slips nor turns under `load_m_per_s2`, its
/// acceleration less that of gravity: palm and fingers both rub, and what hangs beside the hand has
/// to be kept from turning, too.
double load_grip_n(const WaveParameters& grip, const ObjectSpec& object,
                   const Eigen::Vector3d& load_m_per_s2);
/// Whether an object that was put on the palm is in the hand.
bool in_hand(const ObjectSpec& object, const SceneSample& seen);
/// Whether what was in the hand has fallen.
bool fallen(const SceneSample& seen);

/// What an activity knows when a clip begins. The random stream is its own.
struct ActivityStart {
  const ObjectSpec& object;
  RandomStream random;
  const SceneParameters& parameters;  ///< need not outlive the start
};

/// How a person moves. One file and one row in activities.cpp each.
class Activity {
 public:
  virtual ~Activity() = default;
  /// Called once every control interval, in order of time; time 0 is where the clip begins and
  /// earlier times are the grasp. `seen` is the scene at that time.
  virtual Command command(double time_s, const SceneSample& seen) = 0;
  /// Where a ball comes into play at time 0; of activities that have one.
  virtual std::optional<RigidState> serve(const SceneSample&) { return std::nullopt; }
  /// Whether it is over: what the activity is done with was dropped or missed.
  virtual bool lost(const SceneSample& seen) const { return fallen(seen); }
};

/// `step_s` is the physics' step while hand and object touch; `touchtrace-verify scene` measures
/// the error that it costs. `takes` says which objects it is done with. The camera stands so far
/// before the person and looks down by so much that it sees everything.
struct ActivityRow {
  std::string name, summary, default_object;
  double step_s;
  bool (*takes)(const ObjectSpec& object);
  std::unique_ptr<Activity> (*make)(ActivityStart start);
  double camera_distance_m = 1.3, camera_pitch_deg = 8.0;
};
const std::vector<ActivityRow>& activities();
/// Every activity there is, for messages and --help.
std::vector<std::string> activity_names();
/// Throws usage_error with the known names.
const ActivityRow& find_activity(const std::string& name);
/// What it is done with if nothing else is asked for.
const ObjectSpec& default_object(const std::string& activity);
/// Throws usage_error with what does fit unless the activity takes the object.
void require_fit(const ActivityRow& activity, const ObjectSpec& object);

std::unique_ptr<Activity> make_wave(ActivityStart start);
std::unique_ptr<Activity> make_throw(ActivityStart start);
std::unique_ptr<Activity> make_pingpong(ActivityStart start);
std::unique_ptr<Activity> make_balance(ActivityStart start);

/// The orientation of a hand before the person, palm up, fingers away from him, turned by roll
/// about the forearm, pitch about the wrist and yaw.
Eigen::Quaterniond palm_up(double roll_rad, double pitch_rad, double yaw_rad);

}  // namespace touchtrace::scene
