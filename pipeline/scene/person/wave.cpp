#include <algorithm>
#include <cmath>

#include "pipeline/scene/person/regrasp.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

/// Largest acceleration of a planned stroke, limited by the arm's force.
double max_acceleration_m_per_s2(const WaveParameters& wave, const ArmParameters& arm,
                                 double mass_kg) {
  const double force_n = wave.force_fraction * arm.max_force_n - mass_kg * gravity_m_per_s2;
  return std::min(wave.acceleration_m_per_s2, force_n / (arm.mass_kg + mass_kg));
}

/// Bouts of strokes back and forth along one direction; the next stroke is planned before the
/// present one ends. The wrist tilts with the hand's displacement, and the grip force follows the
/// predicted load.
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
  WaveParameters wave_;
  double max_acceleration_m_per_s2_;
  RandomStream random_;
  Vector3d base_m_, centre_m_, direction_;
  double roll_, pitch_, yaw_, tilt_rad_per_m_, base_grip_n_;
  SmoothNoise grip_noise_, roll_noise_, pitch_noise_;
  double amplitude_m_ = 0.0, stroke_s_ = 0.0;
  int strokes_left_ = 0;
  Quintic plan_;
  double replan_s_ = 0.0;
  Regrasp regrasp_;
};

Wave::Wave(ActivityStart start)
    : object_(start.object),
      wave_(start.parameters.wave),
      max_acceleration_m_per_s2_(
          max_acceleration_m_per_s2(wave_, start.parameters.arm, object_.mass_kg)),
      random_(start.random),
      base_m_(draw(random_, wave_.place_m)),
      centre_m_(base_m_),
      roll_(random_.uniform(-0.6, 0.6)),
      pitch_(random_.uniform(-0.3, 0.3)),
      yaw_(random_.uniform(-0.4, 0.4)),
      tilt_rad_per_m_(draw(random_, wave_.tilt_rad_per_m)),
      base_grip_n_(draw(random_, wave_.base_grip_n)),
      grip_noise_(random_, 1.0),
      roll_noise_(random_, wave_.wrist_noise_hz),
      pitch_noise_(random_, wave_.wrist_noise_hz),
      regrasp_(start.parameters.regrasp, object_) {
  const MotionState rest = at_rest(base_m_);
  replan_s_ = random_.uniform(0.0, 0.3);
  plan_ = Quintic(rest, rest, -10.0, replan_s_ + 10.0);
}

void Wave::begin_bout() {
  centre_m_ = base_m_ + 0.03 * Vector3d(random_.normal(), random_.normal(), random_.normal())
                                   .cwiseMax(-2.0)
                                   .cwiseMin(2.0);
  direction_ = Vector3d(random_.normal(), 0.6 * random_.normal(), random_.normal()).normalized();
  stroke_s_ = 0.5 * draw(random_, wave_.period_s);
  const double reach_m = max_acceleration_m_per_s2_ * stroke_s_ * stroke_s_ / minimum_jerk_peak;
  amplitude_m_ = std::min(draw(random_, wave_.amplitude_m), reach_m);
  strokes_left_ = 2 * draw_integer(random_, wave_.repeats);
}

void Wave::plan_next(double time_s) {
  MotionState target = at_rest(centre_m_);
  double duration_s = random_.uniform(0.35, 0.6);
  if (strokes_left_ > 0) {
    const double side = strokes_left_ % 2 ? -0.5 : 0.5;
    target.position_m += side * amplitude_m_ * (1 + 0.1 * random_.normal()) * direction_;
    duration_s = stroke_s_ * (1 + 0.05 * random_.normal());
    --strokes_left_;
  } else {
    begin_bout();
    target.position_m = centre_m_;
    regrasp_.maybe_start(time_s, random_);
  }
  plan_ = Quintic(plan_.at(time_s), target, time_s, duration_s);
  replan_s_ = time_s + duration_s * draw(random_, wave_.replan_fraction);
}

double Wave::grip_force_n(double time_s) const {
  const Vector3d load = plan_.at(time_s + wave_.anticipation_s).acceleration_m_per_s2 +
                        gravity_m_per_s2 * Vector3d::UnitZ();
  const double noise = 1 + wave_.grip_noise * grip_noise_.at(time_s);
  return regrasp_.grip_share(time_s) * noise * (base_grip_n_ + load_grip_n(wave_, object_, load));
}

Eigen::Quaterniond Wave::orientation(double time_s, const Vector3d& place) const {
  const Vector3d tilt = tilt_rad_per_m_ * (place - base_m_);
  const double usual = regrasp_.tilt_share(time_s);
  return palm_up(std::lerp(regrasp_.roll_rad(), roll_ + tilt.x(), usual) +
                     wave_.wrist_noise_rad * roll_noise_.at(time_s),
                 std::lerp(regrasp_.pitch_rad(), pitch_ - tilt.z(), usual) +
                     wave_.wrist_noise_rad * pitch_noise_.at(time_s),
                 yaw_);
}

Command Wave::command(double time_s, const SceneSample& seen) {
  if (time_s >= replan_s_ && regrasp_.is_done()) plan_next(time_s);
  regrasp_.update(time_s, seen);
  Command command;
  command.hand = plan_.at(time_s);
  command.orientation = orientation(time_s, command.hand.position_m);
  command.grip_force_n = grip_force_n(time_s);
  command.closed_grip = !regrasp_.is_open(time_s);
  for (int i = 0; i < num_fingers; ++i) command.posture_rad[i] = regrasp_.posture_rad(i, time_s);
  return command;
}

}  // namespace

std::unique_ptr<Activity> make_wave(ActivityStart start) {
  return std::make_unique<Wave>(std::move(start));
}

}  // namespace touchtrace::scene
