#include "pipeline/scene/world.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double finger_inertia_kg_m2 = 5e-5, finger_damping_nm_s_per_rad = 0.02;
constexpr double impact_speed_m_per_s = 0.3;
constexpr int most_tries = 4;  // at finding which contacts part

Eigen::Quaterniond turned(const Eigen::Quaterniond& orientation, const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0.0) return orientation;
  return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle)) * orientation)
      .normalized();
}

}  // namespace

World::World(const ObjectSpec& spec, const ArmParameters& arm, const ContactParameters& contact)
    : object_spec_(spec), arm_(arm), contact_(contact) {}

World::Velocity World::velocities() const {
  Velocity u;
  u << hand.velocity_m_per_s, object.velocity_m_per_s, object.angular_velocity_rad_per_s,
      Eigen::Map<const Eigen::Matrix<double, finger_count, 1>>(flexion_rate_rad_per_s.data());
  return u;
}

void World::add_masses(System& system, Velocity& momentum, double h) const {
  const Matrix3d rotation = object.orientation.toRotationMatrix();
  const Matrix3d inertia = rotation * object_spec_.inertia_kg_m2 * rotation.transpose();
  const Vector3d& spin = object.angular_velocity_rad_per_s;
  const Vector3d angular = inertia * spin;
  system.diagonal().segment<3>(hand_at).setConstant(arm_.mass_kg);
  system.diagonal().segment<3>(object_at).setConstant(object_spec_.mass_kg);
  system.block<3, 3>(spin_at, spin_at) = inertia;
  momentum.segment<3>(hand_at) = arm_.mass_kg * hand.velocity_m_per_s;
  momentum.segment<3>(object_at) =
      object_spec_.mass_kg * (object.velocity_m_per_s - h * gravity_m_per_s2 * Vector3d::UnitZ());
  momentum.segment<3>(spin_at) = angular - h * spin.cross(angular);
}

void World::add_arm(const Drive& drive, System& system, Velocity& momentum, double h) const {
  const double damping = arm_.damping_n_s_per_m(), gain = h * arm_.stiffness_n_per_m + damping;
  const Vector3d wanted_velocity = drive.velocity_m_per_s + h * drive.acceleration_m_per_s2;
  const Vector3d wanted_position =
      drive.position_m + h * drive.velocity_m_per_s + 0.5 * h * h * drive.acceleration_m_per_s2;
  const Vector3d at_rest = arm_.stiffness_n_per_m * (wanted_position - hand.position_m) +
                           damping * wanted_velocity + arm_.mass_kg * drive.acceleration_m_per_s2 +
                           drive.carried_weight_n * Vector3d::UnitZ();
  const Vector3d force = at_rest - gain * hand.velocity_m_per_s;
  if (const double size = force.norm(); size > arm_.force_bound_n) {
    momentum.segment<3>(hand_at) += h * force * (arm_.force_bound_n / size);
    return;
  }
  momentum.segment<3>(hand_at) += h * at_rest;
  system.diagonal().segment<3>(hand_at).array() += h * gain;
}

void World::add_fingers(const Drive& drive, System& system, Velocity& momentum, double h) const {
  for (int i = 0; i < finger_count; ++i) {
    const FingerDrive& d = drive.fingers[i];
    const double torque = d.torque_nm + d.stiffness_nm_per_rad * (d.rest_rad - flexion_rad[i]);
    momentum[fingers_at + i] = finger_inertia_kg_m2 * flexion_rate_rad_per_s[i] + h * torque;
    system(fingers_at + i, fingers_at + i) =
        finger_inertia_kg_m2 + h * (finger_damping_nm_s_per_rad + h * d.stiffness_nm_per_rad);
  }
}

void World::step(const Drive& drive, double h) {
  const Vector3d& hand_spin = drive.angular_velocity_rad_per_s;
  const Velocity present = velocities();
  contact_.find({object_spec_, hand, object, hand_spin, flexion_rad, present}, h);
  System masses = System::Zero();
  Velocity impulse;
  add_masses(masses, impulse, h);
  add_fingers(drive, masses, impulse, h);
  add_arm(drive, masses, impulse, h);
  Velocity next;
  int tries = 0;
  do {
    System system = masses;
    next = impulse;
    contact_.add_to(system, next, h);
    system.llt().solveInPlace(next);
  } while (contact_.part(next, hand_spin) && ++tries < most_tries);
  contact_.settle(next, hand_spin, h);
  move(next, drive, h);
}

void World::move(const Velocity& next, const Drive& drive, double h) {
  const Vector3d fall = object.velocity_m_per_s;
  hand.velocity_m_per_s = next.segment<3>(hand_at);
  hand.position_m += h * hand.velocity_m_per_s;
  hand.angular_velocity_rad_per_s = drive.angular_velocity_rad_per_s;
  hand.orientation = turned(hand.orientation, h * drive.angular_velocity_rad_per_s);
  object.velocity_m_per_s = next.segment<3>(object_at);
  object.angular_velocity_rad_per_s = next.segment<3>(spin_at);
  // Nothing stiff acts in free flight, where the trapezium rule is exact.
  const Vector3d mean = 0.5 * (fall + object.velocity_m_per_s);
  object.position_m += h * (contact_.touching() ? object.velocity_m_per_s : mean);
  object.orientation = turned(object.orientation, h * object.angular_velocity_rad_per_s);
  for (int i = 0; i < finger_count; ++i) {
    const double wanted = flexion_rad[i] + h * next[fingers_at + i];
    flexion_rad[i] = std::clamp(wanted, 0.0, max_flexion_rad);
    flexion_rate_rad_per_s[i] = flexion_rad[i] == wanted ? next[fingers_at + i] : 0.0;
  }
}

double World::next_step(double step_s) const {
  if (contact_.touching()) return step_s;
  const double speed = (object.velocity_m_per_s - hand.velocity_m_per_s).norm();
  if (contact_.clearance_m() > 4 * step_s * speed + 0.001) return 2 * step_s;
  return speed > impact_speed_m_per_s ? 0.5 * step_s : step_s;
}

void World::advance(const Drive& drive, double interval_s, double step_s) {
  Drive now = drive;
  double left = interval_s;
  mean_force_n_.setZero();
  while (left > 1e-9) {
    const double h = std::min(next_step(step_s), left);
    step(now, h);
    mean_force_n_ += h / interval_s * contact_.force_on_object_n();
    now.position_m += h * now.velocity_m_per_s + 0.5 * h * h * now.acceleration_m_per_s2;
    now.velocity_m_per_s += h * now.acceleration_m_per_s2;
    left -= h;
  }
}

}  // namespace touchtrace::scene
