#include <algorithm>
#include <cmath>

#include "pipeline/scene/activity.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double open_rad = 0.40,
                 trapping_rad = 0.75;  // posture for the toss, and around a caught object
constexpr double posture_s = 0.15, reaction_s = 0.09, catch_error_m = 0.006;

/// Hold, dip, toss off the open cupped palm, watch, move under the object and give way while
/// catching it.
class Throw : public Activity {
 public:
  explicit Throw(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;

 private:
  enum class Phase { hold, dip, toss, watch, meet, give };

  void advance(double time_s, const SceneSample& seen);
  void hold(double time_s);
  void dip(double time_s);
  void toss(double time_s);
  void watch(double time_s);
  void meet(double time_s, const SceneSample& seen);
  void give(double time_s);
  void begin(Phase phase, const MotionState& target, double time_s, double duration_s);
  void bend_to(double posture_rad, double time_s);
  double posture_rad(double time_s) const;

  RandomStream random_;
  Vector3d base_m_, in_palm_m_ = Vector3d::Zero();
  double roll_, pitch_, yaw_;
  SmoothNoise roll_noise_, pitch_noise_;
  Phase phase_ = Phase::hold;
  Quintic plan_;
  double apex_m_ = 0.0;
  double old_posture_rad_ = trapping_rad, new_posture_rad_ = trapping_rad, bend_start_s_ = -10.0;
};

MotionState at_rest(const Vector3d& position) {
  return {position, Vector3d::Zero(), Vector3d::Zero()};
}

Throw::Throw(ActivityStart start)
    : random_(start.random),
      base_m_(random_.uniform(-0.30, -0.04), random_.uniform(-0.46, -0.36),
              random_.uniform(1.02, 1.12)),
      roll_(random_.normal(0.0, 0.03)),
      pitch_(random_.normal(-0.03, 0.03)),
      yaw_(random_.uniform(-0.4, 0.4)),
      roll_noise_(random_, 2.0),
      pitch_noise_(random_, 2.0) {
  plan_ = Quintic(at_rest(base_m_), at_rest(base_m_), -10.0, 10.0 + random_.uniform(0.1, 0.6));
}

void Throw::begin(Phase phase, const MotionState& target, double time_s, double duration_s) {
  phase_ = phase;
  plan_ = Quintic(plan_.at(time_s), target, time_s, duration_s);
}

void Throw::bend_to(double posture, double time_s) {
  old_posture_rad_ = posture_rad(time_s);
  new_posture_rad_ = posture;
  bend_start_s_ = time_s;
}

double Throw::posture_rad(double time_s) const {
  const double s = std::clamp((time_s - bend_start_s_) / posture_s, 0.0, 1.0);
  return old_posture_rad_ +
         (new_posture_rad_ - old_posture_rad_) * s * s * s * (10 - 15 * s + 6 * s * s);
}

void Throw::hold(double time_s) {
  const Vector3d wander(random_.normal(), random_.normal(), random_.normal());
  begin(Phase::hold, at_rest(base_m_ + 0.02 * wander.cwiseMax(-2.0).cwiseMin(2.0)), time_s,
        random_.uniform(0.5, 1.1));
}

void Throw::dip(double time_s) {
  apex_m_ = random_.uniform(0.10, 0.42);
  const double depth_m = 0.04 + 0.30 * apex_m_;
  bend_to(open_rad, time_s);
  begin(Phase::dip, at_rest(plan_.at(time_s).position_m - depth_m * Vector3d::UnitZ()), time_s,
        random_.uniform(0.30, 0.42));
}

void Throw::toss(double time_s) {
  const double speed = std::sqrt(2 * gravity_m_per_s2 * apex_m_);
  const double rise_m = 0.06 + 0.38 * apex_m_;
  MotionState release = plan_.at(time_s);
  release.position_m += rise_m * Vector3d::UnitZ();
  release.velocity_m_per_s = {random_.normal(0.0, 0.03), random_.normal(0.0, 0.03), speed};
  release.acceleration_m_per_s2.setZero();
  begin(Phase::toss, release, time_s, 2 * rise_m / speed);
}

/// Stops the hand while the object goes on.
void Throw::watch(double time_s) {
  const MotionState now = plan_.at(time_s);
  const double duration_s = reaction_s + 0.04;
  begin(Phase::watch, at_rest(now.position_m + 0.4 * duration_s * now.velocity_m_per_s), time_s,
        duration_s);
}

/// Ballistic prediction of where and when the object comes down to the height at which it is met.
void Throw::meet(double time_s, const SceneSample& seen) {
  const Vector3d& p = seen.object.position_m;
  const Vector3d& v = seen.object.velocity_m_per_s;
  const double height_m =
      plan_.at(time_s).position_m.z() + in_palm_m_.z() + random_.uniform(-0.07, 0.0);
  const double above = p.z() - height_m;
  const double fall_s =
      (v.z() + std::sqrt(std::max(0.0, v.z() * v.z() + 2 * gravity_m_per_s2 * above))) /
      gravity_m_per_s2;
  const Vector3d speed = v - gravity_m_per_s2 * fall_s * Vector3d::UnitZ();
  const Vector3d error = catch_error_m * Vector3d(random_.normal(), random_.normal(), 0.0);
  MotionState target;
  target.position_m = p + fall_s * v -
                      0.5 * gravity_m_per_s2 * fall_s * fall_s * Vector3d::UnitZ() - in_palm_m_ +
                      error;
  target.velocity_m_per_s = random_.uniform(0.35, 0.60) * speed;
  begin(Phase::meet, target, time_s, std::max(fall_s, 0.06));
}

void Throw::give(double time_s) {
  const MotionState now = plan_.at(time_s);
  const double duration_s = random_.uniform(0.22, 0.32);
  bend_to(trapping_rad, time_s + 0.03);
  begin(Phase::give, at_rest(now.position_m + 0.45 * duration_s * now.velocity_m_per_s), time_s,
        duration_s);
}

void Throw::advance(double time_s, const SceneSample& seen) {
  switch (phase_) {
    case Phase::hold:
      in_palm_m_ = seen.object.position_m - seen.hand.position_m;
      return dip(time_s);
    case Phase::dip:
      return toss(time_s);
    case Phase::toss:
      return watch(time_s);
    case Phase::watch:
      return meet(time_s, seen);
    case Phase::meet:
      return give(time_s);
    case Phase::give:
      return hold(time_s);
  }
}

Command Throw::command(double time_s, const SceneSample& seen) {
  if (time_s >= plan_.end_s()) advance(time_s, seen);
  Command command;
  command.hand = plan_.at(time_s);
  command.orientation =
      palm_up(roll_ + 0.01 * roll_noise_.at(time_s), pitch_ + 0.01 * pitch_noise_.at(time_s), yaw_);
  command.closed_grip = false;
  const double flexion = posture_rad(time_s);
  command.posture_rad.fill(flexion);
  command.posture_rad.back() = flexion - open_rad;  // the thumb stands aside of the open palm
  command.carrying = phase_ != Phase::watch && phase_ != Phase::meet;
  return command;
}

}  // namespace

std::unique_ptr<Activity> make_throw(ActivityStart start) {
  return std::make_unique<Throw>(std::move(start));
}

}  // namespace touchtrace::scene
