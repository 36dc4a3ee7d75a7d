#include "pipeline/scene/physics/world.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scene/base/rotation.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double min_impact_m_per_s = 0.1;     // slower contacts need no shorter steps
constexpr double impact_error_m_per_s = 0.05;  // accepted error of the speed after an impact
constexpr double max_refinement = 32.0;        // of the step in impacts
constexpr double finger_length_m = 0.08;
constexpr double initial_patch_m2 = 3e-4;  // area assumed before the first contact
constexpr double impact_s = 1e-3;          // contact time of a ball on a racket's rubber
constexpr double min_step_s = 1e-7;        // to an impact of the ball

Eigen::Quaterniond rotated(const Eigen::Quaterniond& orientation, const Vector3d& rotation) {
  return rotation.isZero(0.0) ? orientation
                              : (rotation_from_vector(rotation) * orientation).normalized();
}

}  // namespace

/// State extrapolated by `explicit_s` with the present velocities, in the object's body frame at
/// that time.
struct World::Linearization {
  double theta, implicit_s, explicit_s;
  Matrix3d world_from_object, object_from_world;
  HandInObject hand;
  Vector3d hand_spin, angular_momentum;
  Velocity present;

  Linearization(const World& world, const Vector3d& world_hand_spin, double h, double step_theta)
      : theta(step_theta), implicit_s(step_theta * h), explicit_s(h - implicit_s) {
    const RigidState &from = world.object, &palm = world.hand;
    const Vector3d& spin = from.angular_velocity_rad_per_s;
    const Matrix3d now = from.orientation.toRotationMatrix();
    world_from_object = rotated(from.orientation, explicit_s * spin).toRotationMatrix();
    object_from_world = world_from_object.transpose();
    hand.object_from_hand =
        object_from_world *
        rotated(palm.orientation, explicit_s * world_hand_spin).toRotationMatrix();
    hand.origin_m =
        object_from_world * (palm.position_m - from.position_m +
                             explicit_s * (palm.velocity_m_per_s - from.velocity_m_per_s));
    for (int i = 0; i < num_fingers; ++i)
      hand.flexion_rad[i] =
          std::clamp(world.flexion_rad[i] + explicit_s * world.flexion_rate_rad_per_s[i], 0.0,
                     max_flexion_rad);
    hand_spin = object_from_world * world_hand_spin;
    angular_momentum =
        object_from_world * (now * (world.object_spec_.inertia_kg_m2 * (now.transpose() * spin)));
    present << object_from_world * palm.velocity_m_per_s, object_from_world * from.velocity_m_per_s,
        object_from_world * spin,
        Eigen::Map<const FingerRates>(world.flexion_rate_rad_per_s.data());
  }

  Twist imposed() const { return {-hand_spin.cross(hand.origin_m), hand_spin}; }
  RelativeMotion motion(const Velocity& v) const {
    return {{v.segment<3>(hand_at) - v.segment<3>(object_at) - hand_spin.cross(hand.origin_m),
             hand_spin - v.segment<3>(spin_at)},
            v.tail<num_fingers>()};
  }
};

World::World(const ObjectSpec& spec, const ArmParameters& arm, const ContactParameters& contact,
             const ThetaRange& theta, const FingerParameters& fingers, const HandModel& model)
    : object_spec_(spec),
      inverse_inertia_(spec.inertia_kg_m2.inverse()),
      arm_(arm),
      model_(&model),
      fingers_(fingers),
      theta_(theta),
      contact_(contact, model),
      contact_rate2_per_s2_(contact.stiffness_n_per_m3 * initial_patch_m2 / spec.mass_kg),
      object_rate2_per_s2_(contact_rate2_per_s2_) {}

void World::add_masses(const Linearization& at, MotionSystem& system) const {
  system.bodies.diagonal().segment<3>(hand_at).setConstant(arm_.mass_kg);
  system.bodies.diagonal().segment<3>(object_at).setConstant(object_spec_.mass_kg);
  system.bodies.block<3, 3>(spin_at, spin_at) = object_spec_.inertia_kg_m2;
  const Vector3d fall = at.object_from_world.col(2) * (at.implicit_s * gravity_m_per_s2);
  system.momentum.segment<3>(hand_at) = arm_.mass_kg * at.present.segment<3>(hand_at);
  system.momentum.segment<3>(object_at) =
      object_spec_.mass_kg * (at.present.segment<3>(object_at) - fall);
  system.momentum.segment<3>(spin_at) = at.angular_momentum;
}

void World::add_arm(const Drive& drive, const Linearization& at, MotionSystem& system) const {
  const double h = at.implicit_s, damping = arm_.damping_n_s_per_m(),
               gain = h * arm_.stiffness_n_per_m + damping;
  const Vector3d wanted_velocity = drive.velocity_m_per_s + h * drive.acceleration_m_per_s2;
  const Vector3d wanted_position =
      drive.position_m + h * drive.velocity_m_per_s + 0.5 * h * h * drive.acceleration_m_per_s2;
  const Vector3d at_rest = arm_.stiffness_n_per_m * (wanted_position - hand.position_m) +
                           damping * wanted_velocity + arm_.mass_kg * drive.acceleration_m_per_s2 +
                           drive.carried_weight_n * Vector3d::UnitZ();
  const Vector3d force = at_rest - gain * hand.velocity_m_per_s;
  if (const double size = force.norm(); size > arm_.max_force_n) {
    system.momentum.segment<3>(hand_at) +=
        at.object_from_world * (h * arm_.max_force_n / size * force);
    return;
  }
  system.momentum.segment<3>(hand_at) += at.object_from_world * (h * at_rest);
  system.bodies.diagonal().segment<3>(hand_at).array() += h * gain;
}

void World::add_fingers(const Drive& drive, const Linearization& at, MotionSystem& system) const {
  const double h = at.implicit_s;
  for (int i = 0; i < num_fingers; ++i) {
    const FingerDrive& d = drive.fingers[i];
    const double torque = d.torque_nm + d.stiffness_nm_per_rad * (d.rest_rad - flexion_rad[i]);
    system.momentum[fingers_at + i] =
        fingers_.inertia_kg_m2 * flexion_rate_rad_per_s[i] + h * torque;
    system.fingers[i] =
        fingers_.inertia_kg_m2 + h * (fingers_.damping_nm_s_per_rad + h * d.stiffness_nm_per_rad);
  }
}

/// Half way to implicit Euler where the step is 1.3 periods of the contacts' oscillation.
double World::theta(double h) const {
  const double swings = 0.25 * h * h * contact_rate2_per_s2_;
  return std::lerp(theta_.min, theta_.max, swings * swings / (256.0 + swings * swings));
}

void World::update_contact_rates(const MotionSystem& masses, const MotionSystem& system,
                                 double implicit_s) {
  const auto bodies = (system.bodies - masses.bodies).diagonal().tail<6>().array() /
                      masses.bodies.diagonal().tail<6>().array();
  if (bodies.maxCoeff() <= 0.0) return;
  const double fingers = (system.fingers - masses.fingers).maxCoeff() / fingers_.inertia_kg_m2;
  const double time2 = implicit_s * implicit_s;
  object_rate2_per_s2_ = bodies.head<3>().maxCoeff() / time2;
  contact_rate2_per_s2_ = std::max(bodies.maxCoeff(), fingers) / time2;
}

void World::step(const Drive& drive, double h) {
  const Linearization at(*this, drive.angular_velocity_rad_per_s, h, theta(h));
  contact_.find(object_spec_, at.hand, at.motion(at.present),
                at.motion(at.present + at.explicit_s * acceleration_), at.explicit_s,
                at.implicit_s);
  MotionSystem masses = MotionSystem::zero();
  add_masses(at, masses);
  add_fingers(drive, at, masses);
  add_arm(drive, at, masses);
  Velocity mean;
  do {
    MotionSystem system = masses;
    contact_.add_to(system, at.imposed());
    mean = system.solve();
    update_contact_rates(masses, system, at.implicit_s);
  } while (contact_.release_tensile(at.motion(mean)));
  contact_.finish_step(at.motion(mean), h);
  acceleration_ = (mean - at.present) / at.implicit_s;
  hand.angular_velocity_rad_per_s = drive.angular_velocity_rad_per_s;
  update_state(mean, at, h);
  if (ball) fly(*object_spec_.ball, *ball, h);
}

void World::update_state(const Velocity& mean, const Linearization& at, double h) {
  world_from_contact_ = at.world_from_object;
  const auto world = [&](const auto& v) -> Vector3d { return at.world_from_object * v; };
  const auto extrapolate = [&](Vector3d& velocity, const Vector3d& mean_velocity) {
    velocity += (mean_velocity - velocity) / at.theta;
  };
  const Vector3d hand_mean = world(mean.segment<3>(hand_at)),
                 object_mean = world(mean.segment<3>(object_at)),
                 spin_mean = world(mean.segment<3>(spin_at));
  hand.position_m += h * hand_mean;
  extrapolate(hand.velocity_m_per_s, hand_mean);
  hand.orientation = rotated(hand.orientation, h * hand.angular_velocity_rad_per_s);
  const Vector3d before = object.velocity_m_per_s;
  extrapolate(object.velocity_m_per_s, object_mean);
  // No stiff force acts in free flight, where the trapezoidal rule is exact.
  object.position_m +=
      h * (contact_.touching() ? object_mean : Vector3d(0.5 * (before + object.velocity_m_per_s)));
  Vector3d angular_momentum = at.angular_momentum;
  extrapolate(angular_momentum, object_spec_.inertia_kg_m2 * mean.segment<3>(spin_at));
  object.orientation = rotated(object.orientation, h * spin_mean);
  const Matrix3d now = object.orientation.toRotationMatrix();
  object.angular_velocity_rad_per_s =
      now * (inverse_inertia_ * (now.transpose() * world(angular_momentum)));
  for (int i = 0; i < num_fingers; ++i) {
    const double rate = mean[fingers_at + i], wanted = flexion_rad[i] + h * rate;
    flexion_rad[i] = std::clamp(wanted, 0.0, max_flexion_rad);
    flexion_rate_rad_per_s[i] += (rate - flexion_rate_rad_per_s[i]) / at.theta;
    if (flexion_rad[i] != wanted) flexion_rate_rad_per_s[i] = 0.0;
  }
}

Eigen::Vector3d World::force_on_object_n() const {
  return world_from_contact_ * contact_.force_on_object_n();
}

/// Largest speed of a fingertip that does not touch yet.
double World::closing_m_per_s() const {
  double rate = 0.0;
  for (int i = 0; i < num_fingers; ++i)
    if (contact_.normal_force_n(i) == 0.0) rate = std::max(rate, flexion_rate_rad_per_s[i]);
  return finger_length_m * rate;
}

/// Impacts get steps short enough for the speed after them, whose relative error is about
/// (rate step)^2, and for the tissue's hardening length, which fingers must not pass in a step
/// either.
double World::choose_step_s(double max_step_s) const {
  const bool touching = contact_.touching();
  const double closing = closing_m_per_s(), hardening_m = contact_.parameters().hardening_m;
  const double speed = touching ? contact_.max_speed_m_per_s()
                                : (object.velocity_m_per_s - hand.velocity_m_per_s).norm();
  double fine = std::min(max_step_s, hardening_m / closing);
  if (speed >= min_impact_m_per_s)
    fine = std::min({fine, std::sqrt(impact_error_m_per_s / (object_rate2_per_s2_ * speed)),
                     0.5 * hardening_m / speed});
  fine = std::max(fine, max_step_s / max_refinement);
  return touching ? fine : std::max(fine, contact_.clearance_m() / (speed + closing + 1e-9));
}

double World::time_to_impact_s(double max_step_s) const {
  if (!ball) return max_step_s;
  if (impact_left_s_ > 0.0) return std::min(max_step_s, impact_left_s_);
  return std::max(contact_free_time_s(object_spec_, object, *ball, max_step_s), min_step_s);
}

/// Impacts are at least impact_s apart, so that a ball at rest has finitely many.
void World::resolve_impact(double after_s) {
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
    const double h = std::min(time_to_impact_s(choose_step_s(step_s)), left);
    step(now, h);
    mean_force_n_ += h / interval_s * force_on_object_n();
    now.position_m += h * now.velocity_m_per_s + 0.5 * h * h * now.acceleration_m_per_s2;
    now.velocity_m_per_s += h * now.acceleration_m_per_s2;
    left -= h;
    impact_left_s_ -= h;
    if (ball) resolve_impact(interval_s - left);
  }
}

}  // namespace touchtrace::scene
