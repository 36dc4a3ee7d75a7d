#include <algorithm>
#include <cmath>

#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

/// Posture of the cupped palm from which an object is tossed; the thumb is abducted.
constexpr std::array<double, num_fingers> open_rad{0.40, 0.40, 0.40, 0.40, 0.0};

/// Holds the object in a closed hand, dips while the hand opens, tosses off the cupped palm, stops
/// and watches, moves the palm's centre under the object and rotates it to fit, gives way while the
/// hand closes around the object.
class Throw : public Activity {
 public:
  explicit Throw(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;

 private:
  enum class Phase { hold, dip, toss, watch, meet, give };

  void advance(double time_s, const SceneSample& seen);
  void start_hold(double time_s);
  void start_dip(double time_s, const SceneSample& seen);
  void start_toss(double time_s);
  void start_watch(double time_s);
  void start_meet(double time_s, const SceneSample& seen);
  void start_give(double time_s);
  void begin(Phase phase, const MotionState& target, double time_s, double duration_s);
  void rotate_to(const Quaterniond& turn, double time_s, double duration_s);
  Quaterniond rotation_at(double time_s) const;
  Quaterniond catching_rotation(const RigidState& object, double fall_s) const;

  const ObjectSpec& object_;
  ThrowParameters throw_;
  RandomStream random_;
  Interval apex_range_m_;
  Vector3d base_m_, in_palm_m_ = Vector3d::Zero();
  double roll_, pitch_, yaw_, base_grip_n_;
  SmoothNoise roll_noise_, pitch_noise_;
  Phase phase_ = Phase::hold;
  Quintic plan_;
  Quaterniond old_rotation_ = Quaterniond::Identity(), new_rotation_ = Quaterniond::Identity();
  double rotation_start_s_ = -10.0, rotation_duration_s_ = 1.0;
  std::array<double, num_fingers> held_rad_{};  ///< flexion when the hand began to open
  double opening_start_s_ = -10.0, apex_m_ = 0.0;
};

Interval apex_range_m(const ObjectSpec& object, double scale) {
  const auto& apex_m = *object.toss_apex_m;
  return {scale * apex_m[0], scale * apex_m[1]};
}

Throw::Throw(ActivityStart start)
    : object_(start.object),
      throw_(start.parameters.toss),
      random_(start.random),
      apex_range_m_(apex_range_m(object_, throw_.apex)),
      base_m_(draw(random_, throw_.place_m)),
      roll_(random_.normal(0.0, 0.03)),
      pitch_(random_.normal(-0.03, 0.03)),
      yaw_(random_.uniform(-0.4, 0.4)),
      base_grip_n_(draw(random_, throw_.base_grip_n)),
      roll_noise_(random_, 2.0),
      pitch_noise_(random_, 2.0) {
  plan_ = Quintic(at_rest(base_m_), at_rest(base_m_), -10.0, 10.0 + random_.uniform(0.3, 0.8));
}

void Throw::begin(Phase phase, const MotionState& target, double time_s, double duration_s) {
  phase_ = phase;
  plan_ = Quintic(plan_.at(time_s), target, time_s, duration_s);
}

void Throw::rotate_to(const Quaterniond& turn, double time_s, double duration_s) {
  old_rotation_ = rotation_at(time_s);
  new_rotation_ = turn;
  rotation_start_s_ = time_s;
  rotation_duration_s_ = duration_s;
}

Quaterniond Throw::rotation_at(double time_s) const {
  return old_rotation_.slerp(minimum_jerk_progress(time_s, rotation_start_s_, rotation_duration_s_),
                             new_rotation_);
}

void Throw::start_hold(double time_s) {
  const Vector3d wander(random_.normal(), random_.normal(), random_.normal());
  const double duration_s = random_.uniform(0.5, 1.1);
  begin(Phase::hold, at_rest(base_m_ + 0.02 * wander.cwiseMax(-2.0).cwiseMin(2.0)), time_s,
        duration_s);
  rotate_to(Quaterniond::Identity(), time_s, duration_s);
}

void Throw::start_dip(double time_s, const SceneSample& seen) {
  apex_m_ = draw(random_, apex_range_m_);
  const double depth_m = throw_.dip_m + throw_.dip_per_apex * apex_m_;
  const double shortest_s = std::sqrt(minimum_jerk_peak * depth_m / throw_.dip_m_per_s2);
  held_rad_ = seen.flexion_rad;
  opening_start_s_ = time_s;
  begin(Phase::dip, at_rest(plan_.at(time_s).position_m - depth_m * Vector3d::UnitZ()), time_s,
        std::max(random_.uniform(0.30, 0.42), shortest_s));
}

void Throw::start_toss(double time_s) {
  const double speed = std::sqrt(2 * gravity_m_per_s2 * apex_m_);
  const double rise_m = 0.06 + 0.38 * apex_m_;
  MotionState release = plan_.at(time_s);
  release.position_m += rise_m * Vector3d::UnitZ();
  release.velocity_m_per_s = {random_.normal(0.0, 0.03), random_.normal(0.0, 0.03), speed};
  release.acceleration_m_per_s2.setZero();
  begin(Phase::toss, release, time_s, 2 * rise_m / speed);
}

/// Stops the hand after the release.
void Throw::start_watch(double time_s) {
  const MotionState now = plan_.at(time_s);
  const double flight_s = 2 * now.velocity_m_per_s.z() / gravity_m_per_s2;
  const double duration_s = std::max(throw_.reaction_s, throw_.follow_through * flight_s);
  begin(Phase::watch, at_rest(now.position_m + 0.4 * duration_s * now.velocity_m_per_s), time_s,
        duration_s);
}

/// `axis` or its opposite, whichever is nearer to the direction `to`.
Vector3d flip_towards(const Vector3d& axis, const Vector3d& to) {
  return axis.dot(to) < 0.0 ? Vector3d(-axis) : axis;
}

/// Rotation of the hand that aligns the palm's width with a long spinning object, or the palm with
/// the underside of a flat one, either way round, up to max_rotation_rad. Identity for round
/// objects and cubes.
Quaterniond Throw::catching_rotation(const RigidState& object, double fall_s) const {
  const Hold& hold = object_.hold;
  if (hold.turns != Hold::Turns::none && hold.turns != Hold::Turns::axis)
    return Quaterniond::Identity();
  const Vector3d spin = fall_s * object.angular_velocity_rad_per_s;
  const Quaterniond then =
      Eigen::AngleAxisd(spin.norm(), spin.stableNormalized()) * object.orientation;
  const Quaterniond level = palm_up(roll_, pitch_, yaw_);
  const Vector3d y = flip_towards(then * hold.across, level * Vector3d::UnitY());
  Vector3d z = level * Vector3d::UnitZ();
  if (hold.turns == Hold::Turns::none) z = flip_towards(then * hold.from_palm, z);
  const Vector3d x = y.cross(z).normalized();
  Eigen::Matrix3d suitable;
  suitable << x, y, x.cross(y);
  Eigen::AngleAxisd turn(Quaterniond(suitable) * level.conjugate());
  turn.angle() = std::min(turn.angle(), throw_.max_rotation_rad);
  return Quaterniond(turn);
}

/// Plans to meet the object where and when it ballistically comes down to a random height.
void Throw::start_meet(double time_s, const SceneSample& seen) {
  const Vector3d& p = seen.object.position_m;
  const Vector3d& v = seen.object.velocity_m_per_s;
  const double height_m =
      plan_.at(time_s).position_m.z() + in_palm_m_.z() + random_.uniform(-0.07, 0.0);
  const double above = p.z() - height_m;
  const double fall_s =
      (v.z() + std::sqrt(std::max(0.0, v.z() * v.z() + 2 * gravity_m_per_s2 * above))) /
      gravity_m_per_s2;
  const Vector3d speed = v - gravity_m_per_s2 * fall_s * Vector3d::UnitZ();
  const Vector3d error = throw_.catch_error_m * Vector3d(random_.normal(), random_.normal(), 0.0);
  const Quaterniond turn = catching_rotation(seen.object, fall_s);
  MotionState target;
  target.position_m = p + fall_s * v -
                      0.5 * gravity_m_per_s2 * fall_s * fall_s * Vector3d::UnitZ() -
                      turn * (palm_up(roll_, pitch_, yaw_) * in_palm_m_) + error;
  target.velocity_m_per_s = draw(random_, throw_.catching_speed) * speed;
  begin(Phase::meet, target, time_s, std::max(fall_s, 0.06));
  rotate_to(turn, time_s, plan_.duration_s());
}

void Throw::start_give(double time_s) {
  const MotionState now = plan_.at(time_s);
  const double duration_s = random_.uniform(0.22, 0.32);
  begin(Phase::give, at_rest(now.position_m + 0.45 * duration_s * now.velocity_m_per_s), time_s,
        duration_s);
}

void Throw::advance(double time_s, const SceneSample& seen) {
  switch (phase_) {
    case Phase::hold:
      return start_dip(time_s, seen);
    case Phase::dip:
      return start_toss(time_s);
    case Phase::toss:
      return start_watch(time_s);
    case Phase::watch:
      return start_meet(time_s, seen);
    case Phase::meet:
      return start_give(time_s);
    case Phase::give:
      return start_hold(time_s);
  }
}

Command Throw::command(double time_s, const SceneSample& seen) {
  if (time_s <= 0.0)
    in_palm_m_ =
        seen.hand.orientation.conjugate() * (seen.object.position_m - seen.hand.position_m);
  if (time_s >= plan_.end_s()) advance(time_s, seen);
  Command command;
  command.hand = plan_.at(time_s);
  command.orientation =
      rotation_at(time_s) *
      palm_up(roll_ + 0.01 * roll_noise_.at(time_s), pitch_ + 0.01 * pitch_noise_.at(time_s), yaw_);
  command.closed_grip = phase_ == Phase::hold || phase_ == Phase::give;
  command.grip_force_n =
      base_grip_n_ + (phase_ == Phase::give ? throw_.catching_m_per_s2 * object_.mass_kg : 0.0);
  const double open = minimum_jerk_progress(time_s, opening_start_s_, throw_.opening_s);
  for (int i = 0; i < num_fingers; ++i)
    command.posture_rad[i] = held_rad_[i] + open * (open_rad[i] - held_rad_[i]);
  command.carrying = phase_ != Phase::watch && phase_ != Phase::meet;
  return command;
}

}  // namespace

std::unique_ptr<Activity> make_throw(ActivityStart start) {
  return std::make_unique<Throw>(std::move(start));
}

}  // namespace touchtrace::scene
