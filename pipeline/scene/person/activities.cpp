#include <fmt/core.h>

#include <numbers>

#include "engine/base/error.h"
#include "engine/base/named.h"
#include "engine/base/text.h"
#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {

namespace {

bool is_graspable(const ObjectSpec& object) { return object.role != ObjectRole::tool; }
bool can_be_balanced(const ObjectSpec& object) {
  return object.role == ObjectRole::tool && object.tracked_m != Eigen::Vector3d::Zero();
}
bool can_be_thrown(const ObjectSpec& object) { return object.toss_apex_m.has_value(); }
bool has_ball(const ObjectSpec& object) { return object.ball.has_value(); }

}  // namespace

const std::vector<ActivityRow>& activities() {
  static const std::vector<ActivityRow> table{
      {"wave", "the object is held and waved back and forth", "ball", 0.002, is_graspable,
       make_wave},
      {"throw", "the object is thrown off the open palm and caught", "ball", 0.002, can_be_thrown,
       make_throw},
      {"pingpong", "a ball is bounced on a racket", "racket", 0.002, has_ball, make_pingpong},
      {"balance", "an umbrella is balanced on the open palm", "umbrella", 0.002, can_be_balanced,
       make_balance, 2.0, 1.5},
  };
  return table;
}

std::vector<std::string> activity_names() {
  std::vector<std::string> names;
  for (const ActivityRow& row : activities()) names.push_back(row.name);
  return names;
}

const ActivityRow& find_activity(const std::string& name) {
  return find_named(activities(), "activity", name);
}

const ObjectSpec& default_object(const std::string& activity) {
  return find_object(find_activity(activity).default_object);
}

void require_compatible(const ActivityRow& activity, const ObjectSpec& object) {
  if (activity.accepts(object)) return;
  std::vector<std::string> accepted;
  for (const ObjectSpec& other : objects())
    if (activity.accepts(other)) accepted.push_back(other.name);
  throw usage_error(
      fmt::format("object '{}' cannot be used with activity '{}'", object.name, activity.name),
      "use one of " + comma_separated(accepted));
}

double load_grip_n(const WaveParameters& grip, const ObjectSpec& object,
                   const Eigen::Vector3d& load_m_per_s2) {
  constexpr double min_friction = 0.2;
  const double ratio = grip.grip_over_slip / (2 * std::max(object.friction, min_friction));
  const double turning = 1 + object.hold.center_m.norm() / grip.turning_lever_m;
  return ratio * turning * object.mass_kg * load_m_per_s2.norm();
}

bool is_in_hand(const ObjectSpec& object, const SceneSample& seen) {
  constexpr double max_distance_m = 0.12;
  const RigidState& held = seen.object;
  const Eigen::Vector3d place = held.position_m + held.orientation * object.hold.center_m;
  return seen.grip_force_n > 0.0 && (place - seen.hand.position_m).norm() < max_distance_m;
}

bool has_fallen(const SceneSample& seen) {
  constexpr double below_m = 0.20, max_distance_m = 0.80;
  const Eigen::Vector3d offset = seen.object.position_m - seen.hand.position_m;
  return offset.z() < -below_m || !(offset.norm() < max_distance_m);
}

Eigen::Quaterniond palm_up(double roll_rad, double pitch_rad, double yaw_rad) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double fingers_away = -std::numbers::pi / 2;
  return AngleAxisd(yaw_rad + fingers_away, Vector3d::UnitZ()) *
         AngleAxisd(pitch_rad, Vector3d::UnitY()) * AngleAxisd(roll_rad, Vector3d::UnitX());
}

}  // namespace touchtrace::scene
