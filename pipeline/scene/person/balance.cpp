#include <algorithm>
#include <cmath>
#include <deque>

#include "pipeline/scene/person/activity.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<double, num_fingers> flat_rad{0.05, 0.05, 0.05, 0.05, 0.0};
constexpr double fallen_rad = 0.6;

/// Independent noise along both axes of the horizontal plane.
struct PlaneNoise {
  SmoothNoise x, y;
  PlaneNoise(RandomStream& random, double bandwidth_hz)
      : x(random, bandwidth_hz), y(random, bandwidth_hz) {}
  Vector2d at(double time_s) const { return {x.at(time_s), y.at(time_s)}; }
};

/// Inverted pendulum: a rod that stands on the hand, with a small lean [rad, towards x and y]:
/// lean'' = g / l lean - a / l with the hand's acceleration a and l = I / (m height) + height.
struct Rod {
  double length_m;  ///< l, the distance of the centre of percussion; 2/3 of a uniform rod
  Vector3d axis;    ///< upward, body frame

  explicit Rod(const ObjectSpec& object) : axis(object.hold.from_palm) {
    const double height_m = -object.hold.center_m.dot(axis);
    const Vector3d across = axis.unitOrthogonal();
    length_m = height_m + across.dot(object.inertia_kg_m2 * across) / (object.mass_kg * height_m);
  }
  double rate2_per_s2() const { return gravity_m_per_s2 / length_m; }
};

struct Lean {
  Vector2d angle = Vector2d::Zero(), rate = Vector2d::Zero();
};

Lean lean_of(const Rod& rod, const RigidState& object) {
  const Vector3d up = object.orientation * rod.axis;
  return {up.head<2>(), object.angular_velocity_rad_per_s.cross(up).head<2>()};
}

/// Delayed state feedback with prediction. The person sees the lean with a delay, predicts the
/// present lean from the hand's own accelerations since, and accelerates the hand by pole
/// placement. With the centre of percussion y = x + l lean, y'' = g lean and y'''' = g / l (g lean
/// - a), so all four poles are free. Two mirror the rate at which the rod falls, which costs least
/// effort; the other two return the hand to its rest position.
class Balance : public Activity {
 public:
  explicit Balance(ActivityStart start);
  Command command(double time_s, const SceneSample& seen) override;
  bool is_lost(const SceneSample& seen) const override;

 private:
  Lean see(double time_s, const SceneSample& seen);
  Lean predict(Lean lean) const;
  Vector2d feedback_acceleration(const Lean& lean) const;
  void control(double time_s, Lean lean);
  void move(double time_s, const Vector2d& acceleration);

  BalanceParameters balance_;
  Rod rod_;
  RandomStream random_;
  Vector3d base_m_;
  double roll_, pitch_, yaw_;
  SmoothNoise roll_noise_, pitch_noise_, height_noise_;
  PlaneNoise angle_noise_, rate_noise_, tremor_, push_;
  std::size_t delay_;           ///< control intervals
  std::deque<Lean> seen_;       ///< in the delay
  std::deque<Vector2d> moved_;  ///< commanded accelerations in the prediction interval
  Vector2d upright_ = Vector2d::Zero();
  MotionState hand_;
};

std::size_t num_intervals(double seconds) {
  return static_cast<std::size_t>(std::lround(seconds / control_interval_s));
}

Balance::Balance(ActivityStart start)
    : balance_(start.parameters.balance),
      rod_(start.object),
      random_(start.random),
      base_m_(draw(random_, balance_.place_m)),
      roll_(random_.normal(0.0, balance_.tilt_rad)),
      pitch_(random_.normal(0.0, balance_.tilt_rad)),
      yaw_(random_.uniform(-0.4, 0.4)),
      roll_noise_(random_, balance_.tilt_hz),
      pitch_noise_(random_, balance_.tilt_hz),
      height_noise_(random_, balance_.height_hz),
      angle_noise_(random_, balance_.vision_hz),
      rate_noise_(random_, balance_.vision_hz),
      tremor_(random_, balance_.tremor_hz),
      push_(random_, balance_.tremor_hz),
      delay_(num_intervals(balance_.delay_s)),
      moved_(num_intervals(balance_.prediction_s), Vector2d::Zero()) {
  hand_.position_m = base_m_;
}

/// Returns the lean with noise and delay.
Lean Balance::see(double time_s, const SceneSample& seen) {
  Lean now = lean_of(rod_, seen.object);
  now.angle += balance_.position_noise_m / rod_.length_m * angle_noise_.at(time_s);
  now.rate += balance_.velocity_noise_m_per_s / rod_.length_m * rate_noise_.at(time_s);
  seen_.push_back(now);
  if (seen_.size() > delay_ + 1) seen_.pop_front();
  return seen_.front();
}

Lean Balance::predict(Lean lean) const {
  for (const Vector2d& acceleration : moved_) {
    lean.rate +=
        control_interval_s * (rod_.rate2_per_s2() * lean.angle - acceleration / rod_.length_m);
    lean.angle += control_interval_s * lean.rate;
  }
  return lean;
}

Vector2d Balance::feedback_acceleration(const Lean& lean) const {
  const double g = gravity_m_per_s2, w2 = rod_.rate2_per_s2(), p = std::sqrt(w2),
               q = balance_.homing_per_s;
  const Vector2d y = (hand_.position_m - base_m_).head<2>() + rod_.length_m * lean.angle;
  const Vector2d speed = hand_.velocity_m_per_s.head<2>() + rod_.length_m * lean.rate;
  const double k3 = 2 * (p + q), k2 = p * p + 4 * p * q + q * q, k1 = 2 * p * q * (p + q),
               k0 = p * p * q * q;
  const Vector2d a =
      rod_.length_m * ((w2 + k2) * lean.angle + k3 * lean.rate + (k1 * speed + k0 * y) / g);
  return a * std::min(1.0, balance_.max_acceleration_m_per_s2 / (a.norm() + 1e-9));
}

void Balance::move(double time_s, const Vector2d& acceleration) {
  moved_.push_back(acceleration);
  moved_.pop_front();
  const Vector2d executed =
      acceleration.cwiseProduct(Vector2d::Ones() + balance_.tremor * tremor_.at(time_s)) +
      balance_.tremor_m_per_s2 * push_.at(time_s);
  const double h = control_interval_s;
  hand_.acceleration_m_per_s2.head<2>() = executed;
  hand_.position_m += h * hand_.velocity_m_per_s + 0.5 * h * h * hand_.acceleration_m_per_s2;
  hand_.velocity_m_per_s += h * hand_.acceleration_m_per_s2;
}

void Balance::control(double time_s, Lean lean) {
  upright_ += control_interval_s / balance_.upright_lag_s *
              (lean.angle - moved_.front() / gravity_m_per_s2 - upright_);
  lean.angle -= upright_;
  move(time_s, feedback_acceleration(predict(lean)));
}

Command Balance::command(double time_s, const SceneSample& seen) {
  const Lean lean = see(time_s, seen);
  Command command;
  command.hand = hand_;
  if (time_s >= steadied_until_s) control(time_s, lean);
  command.hand.acceleration_m_per_s2 = hand_.acceleration_m_per_s2;
  command.hand.position_m.z() += balance_.height_m * height_noise_.at(time_s);
  command.orientation = palm_up(roll_ + balance_.tilt_rad * roll_noise_.at(time_s),
                                pitch_ + balance_.tilt_rad * pitch_noise_.at(time_s), yaw_);
  command.closed_grip = false;
  command.posture_rad = flat_rad;
  return command;
}

bool Balance::is_lost(const SceneSample& seen) const {
  return has_fallen(seen) || (seen.object.orientation * rod_.axis).z() < std::cos(fallen_rad);
}

}  // namespace

std::unique_ptr<Activity> make_balance(ActivityStart start) {
  return std::make_unique<Balance>(std::move(start));
}

}  // namespace touchtrace::scene
