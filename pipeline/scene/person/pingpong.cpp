#include <algorithm>
#include <cmath>
#include <deque>

#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/physics/ball.h"

namespace touchtrace::scene {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

constexpr double missed_m = 0.20, away_m = 0.60;
// Fraction of the slip velocity that a hollow sphere loses when an impact ends in rolling.
constexpr double rolling = 0.4;

/// State of the ball at a time.
struct Sighting {
  double time_s;
  RigidState ball;
};

/// Hits a ball up again and again. The person sees the ball with a reaction time, predicts where it
/// comes down, and moves the blade there, tilted so that the ball returns to the centre, with the
/// speed for the intended height and decelerating, as skilled players do (Dijkstra et al. 2004).
class Pingpong : public Activity {
 public:
  explicit Pingpong(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;
  std::optional<RigidState> serve(const SceneSample& seen) override;
  bool is_lost(const SceneSample& seen) const override;

 private:
  void feel_racket(const SceneSample& seen);
  void see_ball(double time_s, const SceneSample& seen);
  void replan(double time_s);
  SmoothNoise noise(double bandwidth_hz) { return {random_, bandwidth_hz}; }
  void draw_next_hit();
  void plan_hit(double time_s, const Sighting& arrival);
  void plan_return(double time_s);
  Sighting seen_at(double time_s) const;
  Vector3d place_noise_at(double time_s) const;
  Sighting predict_arrival(Sighting ball) const;
  Vector3d return_tilt(const Vector3d& arriving, const Vector3d& aside, double approach) const;
  Quaterniond orientation(double time_s) const;
  Vector3d hand_position(double time_s, const Quaterniond& orientation) const;

  const ObjectSpec& object_;
  const Ball& ball_;
  PingpongParameters pingpong_;
  WaveParameters grip_;
  RandomStream random_;
  Vector3d base_m_;
  Quaterniond level_;  ///< orientation of the level hand
  double base_grip_n_, usual_apex_m_;
  SmoothNoise grip_noise_, speed_noise_;
  std::array<SmoothNoise, 3> place_noise_;
  std::array<SmoothNoise, 2> tilt_noise_;
  /// Centre and normal of the blade as felt, hand's frame.
  Vector3d blade_m_ = Vector3d::Zero(), normal_ = Vector3d::UnitZ();
  Quintic place_, tilt_;  ///< of the blade's centre; x and y of its normal
  double planned_s_ = -10.0, hit_s_ = 1e9;
  double apex_m_ = 0.0, swing_ = 1.0, braking_m_per_s2_ = 0.0;  ///< of the next hit
  std::deque<Sighting> sightings_;
};

Pingpong::Pingpong(ActivityStart start)
    : object_(start.object),
      ball_(*start.object.ball),
      pingpong_(start.parameters.pingpong),
      grip_(start.parameters.wave),
      random_(start.random),
      base_m_(draw(random_, pingpong_.place_m)),
      level_(palm_up(0.0, 0.0, random_.uniform(-0.4, 0.4))),
      base_grip_n_(draw(random_, pingpong_.base_grip_n)),
      usual_apex_m_(draw(random_, pingpong_.usual_apex_m)),
      grip_noise_(random_, 1.0),
      speed_noise_(random_, pingpong_.vision_hz),
      place_noise_{noise(pingpong_.vision_hz), noise(pingpong_.vision_hz),
                   noise(pingpong_.vision_hz)},
      tilt_noise_{noise(pingpong_.tilt_noise_hz), noise(pingpong_.tilt_noise_hz)} {
  place_ = Quintic(at_rest(base_m_), at_rest(base_m_), -10.0, 1.0);
  tilt_ = Quintic(at_rest(Vector3d::Zero()), at_rest(Vector3d::Zero()), -10.0, 1.0);
  draw_next_hit();
}

std::optional<RigidState> Pingpong::serve(const SceneSample& seen) {
  RigidState ball;
  const Vector3d error =
      pingpong_.place_error_m * Vector3d(random_.normal(), random_.normal(), 0.0);
  ball.position_m = seen.object.position_m + seen.object.orientation * ball_.face_center_m + error +
                    (usual_apex_m_ + ball_.radius_m) * Vector3d::UnitZ();
  return ball;
}

bool Pingpong::is_lost(const SceneSample& seen) const {
  if (has_fallen(seen)) return true;
  const Vector3d offset = seen.ball->position_m - seen.hand.position_m;
  return offset.z() < -missed_m || !(offset.head<2>().norm() < away_m);
}

/// Low-pass filters the racket's pose in the hand, so that swings do not count.
void Pingpong::feel_racket(const SceneSample& seen) {
  const double share = blade_m_.isZero(0.0) ? 1.0 : control_interval_s / pingpong_.racket_lag_s;
  const Quaterniond hand_from_object = seen.hand.orientation.conjugate() * seen.object.orientation;
  const Vector3d centre =
      seen.hand.orientation.conjugate() * (seen.object.position_m - seen.hand.position_m) +
      hand_from_object * ball_.face_center_m;
  blade_m_ += share * (centre - blade_m_);
  normal_ = (normal_ + share * (hand_from_object * object_.hold.from_palm - normal_)).normalized();
}

void Pingpong::see_ball(double time_s, const SceneSample& seen) {
  if (!seen.ball) return;
  sightings_.push_back({time_s, *seen.ball});
  while (sightings_.size() > 1 && sightings_[1].time_s <= time_s - pingpong_.delay_s)
    sightings_.pop_front();
}

/// Ball state with reaction time (at most since the serve) and noise.
Sighting Pingpong::seen_at(double time_s) const {
  Sighting seen = sightings_.front();
  seen.ball.position_m += pingpong_.place_error_m * place_noise_at(time_s);
  seen.ball.velocity_m_per_s *= 1.0 + pingpong_.speed_error * speed_noise_.at(time_s);
  return seen;
}

Vector3d Pingpong::place_noise_at(double time_s) const {
  return {place_noise_[0].at(time_s), place_noise_[1].at(time_s), place_noise_[2].at(time_s)};
}

/// Time and state at which the ball comes down to the height of the hit; in the past if it is
/// already below.
Sighting Pingpong::predict_arrival(Sighting ball) const {
  constexpr double step_s = 0.01;
  const double height_m = base_m_.z() + ball_.radius_m;
  const auto move = [&](double seconds) {
    fly(ball_, ball.ball, seconds);
    ball.time_s += seconds;
  };
  const RigidState& now = ball.ball;
  do move(step_s);
  while (now.velocity_m_per_s.z() > 0.0 || now.position_m.z() > height_m);
  move((height_m - now.position_m.z()) / now.velocity_m_per_s.z());
  return ball;
}

/// Tilt of the blade that returns a ball with the horizontal velocity `aside` at the speed of
/// `approach`. The spin is not seen and assumed 0.
Vector3d Pingpong::return_tilt(const Vector3d& arriving, const Vector3d& aside,
                               double approach) const {
  const double normal_change = 1.0 + ball_.restitution - rolling;
  Vector3d tilt = (aside - (1.0 - rolling) * arriving) / (normal_change * approach);
  tilt.z() = 0.0;
  return tilt * std::min(1.0, pingpong_.max_tilt_rad / (tilt.norm() + 1e-9));
}

void Pingpong::plan_hit(double time_s, const Sighting& arrival) {
  const RigidState& ball = arrival.ball;
  const double drag = drag_per_m(ball_), e = ball_.restitution;
  const double rise = std::sqrt(std::expm1(2 * drag * apex_m_) * gravity_m_per_s2 / drag);
  const double flight_s = 2 * std::sqrt(2 * apex_m_ / gravity_m_per_s2);
  Vector3d aside = (base_m_ - ball.position_m) / flight_s;
  aside.z() = 0.0;
  aside *= std::min(1.0, pingpong_.max_lateral_speed_m_per_s / (aside.norm() + 1e-9));
  const double fall = ball.velocity_m_per_s.z(), swing = swing_ * (rise + e * fall) / (1 + e);
  const Vector3d tilt = return_tilt(ball.velocity_m_per_s, aside, swing - fall);
  const Vector3d normal = (tilt + Vector3d::UnitZ()).normalized();
  const MotionState hit{ball.position_m - ball_.radius_m * normal, swing * Vector3d::UnitZ(),
                        -braking_m_per_s2_ * Vector3d::UnitZ()};
  const double duration_s = arrival.time_s - time_s;
  place_ = Quintic(place_.at(time_s), hit, time_s, duration_s);
  tilt_ = Quintic(tilt_.at(time_s), at_rest(tilt), time_s, duration_s);
  planned_s_ = time_s;
  hit_s_ = arrival.time_s;
}

/// Moves the blade below the next hit.
void Pingpong::plan_return(double time_s) {
  const Vector3d below = base_m_ - pingpong_.return_m * Vector3d::UnitZ();
  place_ = Quintic(place_.at(time_s), at_rest(below), time_s, pingpong_.return_s);
  tilt_ = Quintic(tilt_.at(time_s), at_rest(Vector3d::Zero()), time_s, pingpong_.return_s);
  draw_next_hit();
  planned_s_ = time_s;
  hit_s_ = 1e9;
}

/// Draws height, error and deceleration of the next hit.
void Pingpong::draw_next_hit() {
  apex_m_ = std::clamp(usual_apex_m_ + pingpong_.apex_std_m * random_.normal(), pingpong_.apex_m[0],
                       pingpong_.apex_m[1]);
  swing_ = 1.0 + pingpong_.swing_error * random_.normal();
  braking_m_per_s2_ = draw(random_, pingpong_.racket_deceleration_m_per_s2);
}

void Pingpong::replan(double time_s) {
  if (time_s + control_interval_s > hit_s_) return plan_return(time_s);
  if (time_s < planned_s_ + pingpong_.replan_s) return;
  const Sighting arrival = predict_arrival(seen_at(time_s));
  if (arrival.time_s > time_s + pingpong_.replan_deadline_s) plan_hit(time_s, arrival);
}

Quaterniond Pingpong::orientation(double time_s) const {
  Vector3d up = tilt_.at(time_s).position_m;
  up += Vector3d(pingpong_.tilt_error_rad * tilt_noise_[0].at(time_s),
                 pingpong_.tilt_error_rad * tilt_noise_[1].at(time_s), 1.0);
  return Quaterniond::FromTwoVectors(level_ * normal_, up) * level_;
}

Vector3d Pingpong::hand_position(double time_s, const Quaterniond& orientation) const {
  return place_.at(time_s).position_m - orientation * blade_m_;
}

Command Pingpong::command(double time_s, const SceneSample& seen) {
  constexpr double h = 0.5 * control_interval_s;
  feel_racket(seen);
  see_ball(time_s, seen);
  if (seen.ball) replan(time_s);
  Command command;
  command.orientation = orientation(time_s);
  const Vector3d before = hand_position(time_s - h, orientation(time_s - h)),
                 now = hand_position(time_s, command.orientation),
                 after = hand_position(time_s + h, orientation(time_s + h));
  command.hand = {now, (after - before) / (2 * h), (after - 2 * now + before) / (h * h)};
  const Vector3d load =
      place_.at(time_s).acceleration_m_per_s2 + gravity_m_per_s2 * Vector3d::UnitZ();
  command.grip_force_n = (1 + grip_.grip_noise * grip_noise_.at(time_s)) *
                         (base_grip_n_ + load_grip_n(grip_, object_, load));
  return command;
}

}  // namespace

std::unique_ptr<Activity> make_pingpong(ActivityStart start) {
  return std::make_unique<Pingpong>(std::move(start));
}

}  // namespace touchtrace::scene
