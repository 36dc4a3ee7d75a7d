#include "pipeline/scene/physics/world.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scene/base/rotation.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double impact_m_per_s = 0.1;         // slower, and any step will do
constexpr double impact_error_m_per_s = 0.05;  // in the speed after an impact
constexpr double finest_share = 32.0;          // of the step in impacts
constexpr double finger_length_m = 0.08;
constexpr double first_patch_m2 = 3e-4;   // expected of a first contact
constexpr double impact_s = 1e-3;         // a racket's rubber and a ball touch that long
constexpr double shortest_step_s = 1e-7;  // to an impact of the ball

Eigen::Quaterniond turned(const Eigen::Quaterniond& orientation, const Vector3d& rotation) {
  return rotation.isZero(0.0) ? orientation : (rotation_by(rotation) * orientation).normalized();
}

}  // namespace

/// Where everything gets in `looked_s` with the present velocities, in the object's axes of then.
struct World::Instant {
  double theta, ahead_s, looked_s;
  Matrix3d world_from_object, object_from_world;
  HandFromObject hand;
  Vector3d hand_spin, angular_momentum;
  Velocity present;

  Instant(const World& world, const Vector3d& world_hand_spin, double h, double share)
      : theta(share), ahead_s(share * h), looked_s(h - ahead_s) {
    const RigidState &from = world.object, &palm = world.hand;
    const Vector3d& spin = from.angular_velocity_rad_per_s;
    const Matrix3d now = from.orientation.toRotationMatrix();
    world_from_object = turned(from.orientation, looked_s * spin).toRotationMatrix();
    object_from_world = world_from_object.transpose();
    hand.object_from_hand =
        object_from_world * turned(palm.orientation, looked_s * world_hand_spin).toRotationMatrix();
    hand.hand_m = object_from_world * (palm.position_m - from.position_m +
                                       looked_s * (palm.velocity_m_per_s - from.velocity_m_per_s));
    for (int i = 0; i < finger_count; ++i)
      hand.flexion_rad[i] = std::clamp(
          world.flexion_rad[i] + looked_s * world.flexion_rate_rad_per_s[i], 0.0, max_flexion_rad);
    hand_spin = object_from_world * world_hand_spin;
    angular_momentum =
        object_from_world * (now * (world.object_spec_.inertia_kg_m2 * (now.transpose() * spin)));
    present << object_from_world * palm.velocity_m_per_s, object_from_world * from.velocity_m_per_s,
        object_from_world * spin,
        Eigen::Map<const FingerRates>(world.flexion_rate_rad_per_s.data());
  }

  Twist imposed() const { return {-hand_spin.cross(hand.hand_m), hand_spin}; }
  RelativeMotion motion(const Velocity& v) const {
    return {{v.segment<3>(hand_at) - v.segment<3>(object_at) - hand_spin.cross(hand.hand_m),
             hand_spin - v.segment<3>(spin_at)},
            v.tail<finger_count>()};
  }
};

World::World(const ObjectSpec& spec, const ArmParameters& arm, const ContactParameters& contact,
             const Implicitness& implicitness, const FingerParameters& fingers,
             const HandModel& model)
    : object_spec_(spec),
      inverse_inertia_(spec.inertia_kg_m2.inverse()),
      arm_(arm),
      model_(&model),
      fingers_(fingers),
      implicitness_(implicitness),
      contact_(contact, model),
      contact_rate2_per_s2_(contact.stiffness_n_per_m3 * first_patch_m2 / spec.mass_kg),
      object_rate2_per_s2_(contact_rate2_per_s2_) {}

void World::add_masses(const Instant& at, MotionSystem& system) const {
  system.bodies.diagonal().segment<3>(hand_at).setConstant(arm_.mass_kg);
  system.bodies.diagonal().segment<3>(object_at).setConstant(object_spec_.mass_kg);
  system.bodies.block<3, 3>(spin_at, spin_at) = object_spec_.inertia_kg_m2;
  const Vector3d fall = at.object_from_world.col(2) * (at.ahead_s * gravity_m_per_s2);
  system.momentum.segment<3>(hand_at) = arm_.mass_kg * at.present.segment<3>(hand_at);
  system.momentum.segment<3>(object_at) =
      object_spec_.mass_kg * (at.present.segment<3>(object_at) - fall);
  system.momentum.segment<3>(spin_at) = at.angular_momentum;
}

void World::add_arm(const Drive& drive, const Instant& at, MotionSystem& system) const {
  const double h = at.ahead_s, damping = arm_.damping_n_s_per_m(),
               gain = h * arm_.stiffness_n_per_m + damping;
  const Vector3d wanted_velocity = drive.velocity_m_per_s + h * drive.acceleration_m_per_s2;
  const Vector3d wanted_position =
      drive.position_m + h * drive.velocity_m_per_s + 0.5 * h * h * drive.acceleration_m_per_s2;
  const Vector3d at_rest = arm_.stiffness_n_per_m * (wanted_position - hand.position_m) +
                           damping * wanted_velocity + arm_.mass_kg * drive.acceleration_m_per_s2 +
                           drive.carried_weight_n * Vector3d::UnitZ();
  const Vector3d force = at_rest - gain * hand.velocity_m_per_s;
  if (const double size = force.norm(); size > arm_.force_bound_n) {
    system.momentum.segment<3>(hand_at) +=
        at.object_from_world * (h * arm_.force_bound_n / size * force);
    return;
  }
  system.momentum.segment<3>(hand_at) += at.object_from_world * (h * at_rest);
  system.bodies.diagonal().segment<3>(hand_at).array() += h * gain;
}

void World::add_fingers(const Drive& drive, const Instant& at, MotionSystem& system) const {
  const double h = at.ahead_s;
  for (int i = 0; i < finger_count; ++i) {
    const FingerDrive& d = drive.fingers[i];
    const double torque = d.torque_nm + d.stiffness_nm_per_rad * (d.rest_rad - flexion_rad[i]);
    system.momentum[fingers_at + i] =
        fingers_.inertia_kg_m2 * flexion_rate_rad_per_s[i] + h * torque;
    system.fingers[i] =
        fingers_.inertia_kg_m2 + h * (fingers_.damping_nm_s_per_rad + h * d.stiffness_nm_per_rad);
  }
}

/// Half way to implicit Euler where the step is 1.3 swings of the contacts.
double World::implicitness(double h) const {
  const double swings = 0.25 * h * h * contact_rate2_per_s2_;
  return std::lerp(implicitness_.least, implicitness_.most,
                   swings * swings / (256.0 + swings * swings));
}

void World::note_rates(const MotionSystem& masses, const MotionSystem& system, double ahead_s) {
  const auto bodies = (system.bodies - masses.bodies).diagonal().tail<6>().array() /
                      masses.bodies.diagonal().tail<6>().array();
  if (bodies.maxCoeff() <= 0.0) return;
  const double fingers = (system.fingers - masses.fingers).maxCoeff() / fingers_.inertia_kg_m2;
  const double time2 = ahead_s * ahead_s;
  object_rate2_per_s2_ = bodies.head<3>().maxCoeff() / time2;
  contact_rate2_per_s2_ = std::max(bodies.maxCoeff(), fingers) / time2;
}

void World::step(const Drive& drive, double h) {
  const Instant at(*this, drive.angular_velocity_rad_per_s, h, implicitness(h));
  contact_.find(object_spec_, at.hand, at.motion(at.present),
                at.motion(at.present + at.looked_s * acceleration_), at.looked_s, at.ahead_s);
  MotionSystem masses = MotionSystem::zero();
  add_masses(at, masses);
  add_fingers(drive, at, masses);
  add_arm(drive, at, masses);
  Velocity mean;
  do {
    MotionSystem system = masses;
    contact_.add_to(system, at.imposed());
    mean = system.solve();
    note_rates(masses, system, at.ahead_s);
  } while (contact_.part(at.motion(mean)));
  contact_.settle(at.motion(mean), h);
  acceleration_ = (mean - at.present) / at.ahead_s;
  hand.angular_velocity_rad_per_s = drive.angular_velocity_rad_per_s;
  move(mean, at, h);
  if (ball) fly(*object_spec_.ball, *ball, h);
}

void World::move(const Velocity& mean, const Instant& at, double h) {
  world_from_contact_ = at.world_from_object;
  const auto world = [&](const auto& v) -> Vector3d { return at.world_from_object * v; };
  const auto onward = [&](Vector3d& velocity, const Vector3d& middle) {
    velocity += (middle - velocity) / at.theta;
  };
  const Vector3d hand_mean = world(mean.segment<3>(hand_at)),
                 object_mean = world(mean.segment<3>(object_at)),
                 spin_mean = world(mean.segment<3>(spin_at));
  hand.position_m += h * hand_mean;
  onward(hand.velocity_m_per_s, hand_mean);
  hand.orientation = turned(hand.orientation, h * hand.angular_velocity_rad_per_s);
  const Vector3d before = object.velocity_m_per_s;
  onward(object.velocity_m_per_s, object_mean);
  // Nothing stiff acts in free flight, where the trapezium rule is exact.
  object.position_m +=
      h * (contact_.touching() ? object_mean : Vector3d(0.5 * (before + object.velocity_m_per_s)));
  Vector3d angular_momentum = at.angular_momentum;
  onward(angular_momentum, object_spec_.inertia_kg_m2 * mean.segment<3>(spin_at));
  object.orientation = turned(object.orientation, h * spin_mean);
  const Matrix3d now = object.orientation.toRotationMatrix();
  object.angular_velocity_rad_per_s =
      now * (inverse_inertia_ * (now.transpose() * world(angular_momentum)));
  for (int i = 0; i < finger_count; ++i) {
    const double rate = mean[fingers_at + i], wanted = flexion_rad[i] + h * rate;
    flexion_rad[i] = std::clamp(wanted, 0.0, max_flexion_rad);
    flexion_rate_rad_per_s[i] += (rate - flexion_rate_rad_per_s[i]) / at.theta;
    if (flexion_rad[i] != wanted) flexion_rate_rad_per_s[i] = 0.0;
  }
}

Eigen::Vector3d World::force_on_object_n() const {
  return world_from_contact_ * contact_.force_on_object_n();
}

/// Of fingers that touch nothing yet.
double World::closing_m_per_s() const {
  double rate = 0.0;
  for (int i = 0; i < finger_count; ++i)
    if (contact_.normal_force_n(i) == 0.0) rate = std::max(rate, flexion_rate_rad_per_s[i]);
  return finger_length_m * rate;
}

/// Impacts are followed closely enough for the speed after them, the rule's error in which is about
/// (rate step)^2 of the speed, and for the tissue, which a finger must not run through either.
double World::next_step(double step_s) const {
  const bool touching = contact_.touching();
  const double closing = closing_m_per_s(), hardening_m = contact_.parameters().hardening_m;
  const double speed = touching ? contact_.fastest_m_per_s()
                                : (object.velocity_m_per_s - hand.velocity_m_per_s).norm();
  double fine = std::min(step_s, hardening_m / closing);
  if (speed >= impact_m_per_s)
    fine = std::min({fine, std::sqrt(impact_error_m_per_s / (object_rate2_per_s2_ * speed)),
                     0.5 * hardening_m / speed});
  fine = std::max(fine, step_s / finest_share);
  return touching ? fine : std::max(fine, contact_.clearance_m() / (speed + closing + 1e-9));
}

double World::until_impact(double step_s) const {
  if (!ball) return step_s;
  if (impact_left_s_ > 0.0) return std::min(step_s, impact_left_s_);
  return std::max(free_time_s(object_spec_, object, *ball, step_s), shortest_step_s);
}

/// The next impact comes when this one is over, so a ball at rest has no endless number of them.
void World::meet_ball(double after_s) {
  if (impact_left_s_ > 0.0) return;
  const auto impact = bounce(object_spec_, restitution, object, *ball);
  if (!impact) return;
  impact_left_s_ = impact_s;
  if (impact->approach_m_per_s > 0.0) impacts_.push_back({*impact, after_s});
}

void World::advance(const Drive& drive, double interval_s, double step_s) {
  Drive now = drive;
  double left = interval_s;
  mean_force_n_.setZero();
  impacts_.clear();
  while (left > 1e-9) {
    const double h = std::min(until_impact(next_step(step_s)), left);
    step(now, h);
    mean_force_n_ += h / interval_s * force_on_object_n();
    now.position_m += h * now.velocity_m_per_s + 0.5 * h * h * now.acceleration_m_per_s2;
    now.velocity_m_per_s += h * now.acceleration_m_per_s2;
    left -= h;
    impact_left_s_ -= h;
    if (ball) meet_ball(interval_s - left);
  }
}

}  // namespace touchtrace::scene
