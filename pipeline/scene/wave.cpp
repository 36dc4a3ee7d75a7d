#include <algorithm>
#include <cmath>

#include "pipeline/scene/activity.h"
#include "pipeline/scene/world.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double anticipation_s = 0.06;
constexpr double grip_over_slip = 1.26;  // what is gripped with, over what would just slip
constexpr double palm_lever_m = 0.04, slipperiest = 0.2;
constexpr double strength_used = 0.9;  // of what the arm can do

/// Of a planned sub-movement: what one does with something light, and not more than the arm can.
double hardest_m_per_s2(double mass_kg) {
  const ArmParameters arm;
  const double force_n = strength_used * arm.force_bound_n - mass_kg * gravity_m_per_s2;
  return std::min(18.0, force_n / (arm.mass_kg + mass_kg));
}

/// Bouts of to-and-fro sub-movements along one direction, each re-planned before it ends; the wrist
/// tilts with the hand's place and the grip follows the load that is about to come.
class Wave : public Activity {
 public:
  explicit Wave(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;

 private:
  void plan_next(double time_s);
  void begin_bout();
  double grip_force_n(double time_s) const;
  Eigen::Quaterniond orientation(double time_s, const Vector3d& place) const;

  const ObjectSpec& object_;
  RandomStream random_;
  Vector3d base_m_, centre_m_, direction_;
  double roll_, pitch_, yaw_, tilt_rad_per_m_, base_grip_n_;
  SmoothNoise grip_noise_, roll_noise_, pitch_noise_;
  double amplitude_m_ = 0.0, stroke_s_ = 0.0;
  int strokes_left_ = 0;
  Quintic plan_;
  double replan_s_ = 0.0;
};

Wave::Wave(ActivityStart start)
    : object_(start.object),
      random_(start.random),
      base_m_(random_.uniform(-0.30, 0.02), random_.uniform(-0.55, -0.42),
              random_.uniform(1.08, 1.30)),
      centre_m_(base_m_),
      roll_(random_.uniform(-0.6, 0.6)),
      pitch_(random_.uniform(-0.3, 0.3)),
      yaw_(random_.uniform(-0.4, 0.4)),
      tilt_rad_per_m_(random_.uniform(1.5, 1.8)),
      base_grip_n_(random_.uniform(4.0, 8.0)),
      grip_noise_(random_, 1.0),
      roll_noise_(random_, 2.0),
      pitch_noise_(random_, 2.0) {
  const MotionState rest{base_m_, Vector3d::Zero(), Vector3d::Zero()};
  replan_s_ = random_.uniform(0.0, 0.3);
  plan_ = Quintic(rest, rest, -10.0, replan_s_ + 10.0);
}

void Wave::begin_bout() {
  centre_m_ = base_m_ + 0.03 * Vector3d(random_.normal(), random_.normal(), random_.normal())
                                   .cwiseMax(-2.0)
                                   .cwiseMin(2.0);
  direction_ = Vector3d(random_.normal(), 0.6 * random_.normal(), random_.normal()).normalized();
  stroke_s_ = 0.5 * random_.uniform(0.22, 0.9);
  const double reach_m =
      hardest_m_per_s2(object_.mass_kg) * stroke_s_ * stroke_s_ / minimum_jerk_peak;
  amplitude_m_ = std::min(random_.uniform(0.04, 0.16), reach_m);
  strokes_left_ = 2 * (2 + static_cast<int>(random_.below(7)));
}

void Wave::plan_next(double time_s) {
  MotionState target{centre_m_, Vector3d::Zero(), Vector3d::Zero()};
  double duration_s = random_.uniform(0.35, 0.6);
  if (strokes_left_ > 0) {
    const double side = strokes_left_ % 2 ? -0.5 : 0.5;
    target.position_m += side * amplitude_m_ * (1 + 0.1 * random_.normal()) * direction_;
    duration_s = stroke_s_ * (1 + 0.05 * random_.normal());
    --strokes_left_;
  } else {
    begin_bout();
    target.position_m = centre_m_;
  }
  plan_ = Quintic(plan_.at(time_s), target, time_s, duration_s);
  replan_s_ = time_s + duration_s * random_.uniform(0.8, 0.97);
}

/// Palm and fingers both rub; what hangs beside the hand has to be kept from turning, too.
double Wave::grip_force_n(double time_s) const {
  const Vector3d load = plan_.at(time_s + anticipation_s).acceleration_m_per_s2 +
                        gravity_m_per_s2 * Vector3d::UnitZ();
  const double noise = 1 + 0.1 * grip_noise_.at(time_s);
  const double ratio = grip_over_slip / (2 * std::max(object_.friction, slipperiest));
  const double turning = 1 + object_.hold.center_m.norm() / palm_lever_m;
  return noise * (base_grip_n_ + ratio * turning * object_.mass_kg * load.norm());
}

Eigen::Quaterniond Wave::orientation(double time_s, const Vector3d& place) const {
  const Vector3d away = tilt_rad_per_m_ * (place - base_m_);
  return palm_up(roll_ + away.x() + 0.04 * roll_noise_.at(time_s),
                 pitch_ - away.z() + 0.04 * pitch_noise_.at(time_s), yaw_);
}

Command Wave::command(double time_s, const SceneSample&) {
  if (time_s >= replan_s_) plan_next(time_s);
  Command command;
  command.hand = plan_.at(time_s);
  command.orientation = orientation(time_s, command.hand.position_m);
  command.grip_force_n = grip_force_n(time_s);
  return command;
}

}  // namespace

std::unique_ptr<Activity> make_wave(ActivityStart start) {
  return std::make_unique<Wave>(std::move(start));
}

}  // namespace touchtrace::scene
