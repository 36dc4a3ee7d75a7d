#include <algorithm>
#include <cmath>
#include <deque>

#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/physics/ball.h"

namespace touchtrace::scene {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

constexpr double missed_m = 0.20, away_m = 0.60;
constexpr double rolling = 0.4;  // of the slip that a hollow ball leaves on a surface it rolls on

/// The ball as it was at a time.
struct Sighting {
  double time_s;
  RigidState ball;
};

/// A ball is hit up again and again. The person sees where it was a reaction time ago, predicts
/// where it comes down, and brings the blade there, tilted so that the ball goes back to the
/// middle, with the speed for the height wanted and braking already, as the skilled do (Dijkstra et
/// al. 2004).
class Pingpong : public Activity {
 public:
  explicit Pingpong(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;
  std::optional<RigidState> serve(const SceneSample& seen) override;
  bool lost(const SceneSample& seen) const override;

 private:
  void feel(const SceneSample& seen);
  void look(double time_s, const SceneSample& seen);
  void think(double time_s);
  SmoothNoise noise(double bandwidth_hz) { return {random_, bandwidth_hz}; }
  void intend();
  void plan_hit(double time_s, const Sighting& arrival);
  void plan_return(double time_s);
  Sighting seen_at(double time_s) const;
  Vector3d place_noise_at(double time_s) const;
  Sighting coming_down(Sighting ball) const;
  Vector3d suitable_tilt(const Vector3d& arriving, const Vector3d& aside, double approach) const;
  Quaterniond orientation(double time_s) const;
  Vector3d hand_position(double time_s, const Quaterniond& orientation) const;

  const ObjectSpec& object_;
  const Ball& ball_;
  PingpongParameters pingpong_;
  WaveParameters grip_;
  RandomStream random_;
  Vector3d base_m_;
  Quaterniond level_;  ///< of the hand, fingers away from the person and a little aside
  double base_grip_n_, usual_apex_m_;
  SmoothNoise grip_noise_, speed_noise_;
  std::array<SmoothNoise, 3> place_noise_;
  std::array<SmoothNoise, 2> tilt_noise_;
  /// Of the blade in the hand: its middle and its normal.
  Vector3d blade_m_ = Vector3d::Zero(), normal_ = Vector3d::UnitZ();
  Quintic place_, tilt_;  ///< of the blade's middle; of its normal (x and y) from the vertical
  double planned_s_ = -10.0, hit_s_ = 1e9;
  double apex_m_ = 0.0, swing_ = 1.0, braking_m_per_s2_ = 0.0;  ///< of the next hit
  std::deque<Sighting> sightings_;
};

MotionState resting(const Vector3d& position) {
  return {position, Vector3d::Zero(), Vector3d::Zero()};
}

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
      speed_noise_(random_, pingpong_.sight_noise_hz),
      place_noise_{noise(pingpong_.sight_noise_hz), noise(pingpong_.sight_noise_hz),
                   noise(pingpong_.sight_noise_hz)},
      tilt_noise_{noise(pingpong_.tilt_noise_hz), noise(pingpong_.tilt_noise_hz)} {
  place_ = Quintic(resting(base_m_), resting(base_m_), -10.0, 1.0);
  tilt_ = Quintic(resting(Vector3d::Zero()), resting(Vector3d::Zero()), -10.0, 1.0);
  intend();
}

std::optional<RigidState> Pingpong::serve(const SceneSample& seen) {
  RigidState ball;
  const Vector3d error =
      pingpong_.place_error_m * Vector3d(random_.normal(), random_.normal(), 0.0);
  ball.position_m = seen.object.position_m + seen.object.orientation * ball_.meets_m + error +
                    (usual_apex_m_ + ball_.radius_m) * Vector3d::UnitZ();
  return ball;
}

bool Pingpong::lost(const SceneSample& seen) const {
  if (fallen(seen)) return true;
  const Vector3d offset = seen.ball->position_m - seen.hand.position_m;
  return offset.z() < -missed_m || !(offset.head<2>().norm() < away_m);
}

/// The racket's place in the hand, as it is felt; slowly, so that swings do not count.
void Pingpong::feel(const SceneSample& seen) {
  const double share = blade_m_.isZero(0.0) ? 1.0 : control_interval_s / pingpong_.feeling_s;
  const Quaterniond hand_from_object = seen.hand.orientation.conjugate() * seen.object.orientation;
  const Vector3d middle =
      seen.hand.orientation.conjugate() * (seen.object.position_m - seen.hand.position_m) +
      hand_from_object * ball_.meets_m;
  blade_m_ += share * (middle - blade_m_);
  normal_ = (normal_ + share * (hand_from_object * object_.hold.from_palm - normal_)).normalized();
}

void Pingpong::look(double time_s, const SceneSample& seen) {
  if (!seen.ball) return;
  sightings_.push_back({time_s, *seen.ball});
  while (sightings_.size() > 1 && sightings_[1].time_s <= time_s - pingpong_.delay_s)
    sightings_.pop_front();
}

/// As it was a reaction time ago, or when it was let go.
Sighting Pingpong::seen_at(double time_s) const {
  Sighting seen = sightings_.front();
  seen.ball.position_m += pingpong_.place_error_m * place_noise_at(time_s);
  seen.ball.velocity_m_per_s *= 1.0 + pingpong_.speed_error * speed_noise_.at(time_s);
  return seen;
}

Vector3d Pingpong::place_noise_at(double time_s) const {
  return {place_noise_[0].at(time_s), place_noise_[1].at(time_s), place_noise_[2].at(time_s)};
}

/// When and how it comes down to the height at which it is hit; in the past if it is below.
Sighting Pingpong::coming_down(Sighting ball) const {
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

/// The tilt that sends the ball on with `aside`, met at `approach`; its spin is not seen.
Vector3d Pingpong::suitable_tilt(const Vector3d& arriving, const Vector3d& aside,
                                 double approach) const {
  const double turned = 1.0 + ball_.restitution - rolling;
  Vector3d tilt = (aside - (1.0 - rolling) * arriving) / (turned * approach);
  tilt.z() = 0.0;
  return tilt * std::min(1.0, pingpong_.tilt_rad / (tilt.norm() + 1e-9));
}

void Pingpong::plan_hit(double time_s, const Sighting& arrival) {
  const RigidState& ball = arrival.ball;
  const double drag = drag_per_m(ball_), e = ball_.restitution;
  const double rise = std::sqrt(std::expm1(2 * drag * apex_m_) * gravity_m_per_s2 / drag);
  const double flight_s = 2 * std::sqrt(2 * apex_m_ / gravity_m_per_s2);
  Vector3d aside = (base_m_ - ball.position_m) / flight_s;
  aside.z() = 0.0;
  aside *= std::min(1.0, pingpong_.aside_m_per_s / (aside.norm() + 1e-9));
  const double fall = ball.velocity_m_per_s.z(), swing = swing_ * (rise + e * fall) / (1 + e);
  const Vector3d tilt = suitable_tilt(ball.velocity_m_per_s, aside, swing - fall);
  const Vector3d normal = (tilt + Vector3d::UnitZ()).normalized();
  const MotionState hit{ball.position_m - ball_.radius_m * normal, swing * Vector3d::UnitZ(),
                        -braking_m_per_s2_ * Vector3d::UnitZ()};
  const double duration_s = arrival.time_s - time_s;
  place_ = Quintic(place_.at(time_s), hit, time_s, duration_s);
  tilt_ = Quintic(tilt_.at(time_s), resting(tilt), time_s, duration_s);
  planned_s_ = time_s;
  hit_s_ = arrival.time_s;
}

/// After a hit, to below where the next one is meant to be.
void Pingpong::plan_return(double time_s) {
  const Vector3d below = base_m_ - pingpong_.return_m * Vector3d::UnitZ();
  place_ = Quintic(place_.at(time_s), resting(below), time_s, pingpong_.return_s);
  tilt_ = Quintic(tilt_.at(time_s), resting(Vector3d::Zero()), time_s, pingpong_.return_s);
  intend();
  planned_s_ = time_s;
  hit_s_ = 1e9;
}

/// What is meant to come of the next hit, and what comes of it.
void Pingpong::intend() {
  apex_m_ = std::clamp(usual_apex_m_ + pingpong_.apex_spread_m * random_.normal(),
                       pingpong_.apex_m[0], pingpong_.apex_m[1]);
  swing_ = 1.0 + pingpong_.swing_error * random_.normal();
  braking_m_per_s2_ = draw(random_, pingpong_.braking_m_per_s2);
}

void Pingpong::think(double time_s) {
  if (time_s + control_interval_s > hit_s_) return plan_return(time_s);
  if (time_s < planned_s_ + pingpong_.replan_s) return;
  const Sighting arrival = coming_down(seen_at(time_s));
  if (arrival.time_s > time_s + pingpong_.last_change_s) plan_hit(time_s, arrival);
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
  feel(seen);
  look(time_s, seen);
  if (seen.ball) think(time_s);
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
