#include "tests/verify/scene/grip_closed_forms.h"

#include <cmath>
#include <numbers>

#include "tests/verify/scene/setups.h"
#include "tests/verify/scene/small_oscillations.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double no_slip = 1e3;  // coefficient of friction
constexpr double rod_kg = 0.3;
// A foot whose edges are midway between taxels, on the fore half of the palm.
const Vector3d foot_half_m(0.0193, 0.021, 0.02), foot_on_palm_m(0.01285, 0.0, 0.0);

ContactParameters linear_springs(double dissipation_s_per_m) {
  ContactParameters contact;
  contact.hardening_m = 1e9;
  contact.dissipation_s_per_m = dissipation_s_per_m;
  return contact;
}

/// A foot on a thin rod.
ObjectSpec rod_on_foot(double height_m, const Vector3d& foot_from_mass_m) {
  const double across = rod_kg * height_m * height_m / 3.0;
  ObjectSpec rod = block(rod_kg, no_slip, foot_half_m);
  rod.inertia_kg_m2 = Vector3d(across, across, 1e-3).asDiagonal();
  rod.solids[0].body_from_shape.translation() = foot_from_mass_m;
  return rod;
}

/// Total force and centre of pressure of the springs under a level face at `face_m`.
struct Support {
  double force_n = 0.0;
  Vector3d center_m = Vector3d::Zero();
};

Support support_of(const Vector3d& face_m, const ContactParameters& contact) {
  Support support;
  for (const Taxel& taxel : hand_model().taxels) {
    const Vector3d from = taxel.position_m - face_m;
    if (taxel.finger >= 0 || (from.cwiseAbs().array() > foot_half_m.array()).any() ||
        from.z() < 0.0)
      continue;
    const double force = contact.stiffness_n_per_m3 * taxel.area_m2 * from.z();
    support.force_n += force;
    support.center_m += force * from;
  }
  support.center_m /= support.force_n;
  return support;
}

/// A rod upright and at rest, its centre of mass over the centre of pressure.
World standing_rod(double height_m, const ContactParameters& contact) {
  Vector3d face = foot_on_palm_m;
  double low = -0.005, high = 0.005;
  for (int i = 0; i < 100; ++i) {
    face.z() = 0.5 * (low + high);
    (support_of(face, contact).force_n > rod_kg * gravity_m_per_s2 ? low : high) = face.z();
  }
  Vector3d mass_from_face = support_of(face, contact).center_m;
  mass_from_face.z() = height_m;
  World world(rod_on_foot(height_m, foot_half_m.z() * Vector3d::UnitZ() - mass_from_face),
              rigid_arm(), contact);
  world.object.position_m = face + mass_from_face;
  return world;
}

const Vector3d shaken_along = Vector3d(1.0, 2.0, 2.0) / 3.0;

ObjectSpec gripped_block(double friction) { return block(0.3, friction, {0.02, 0.045, 0.02}); }

Drive gripping_drive(const World& world) {
  Drive drive = hold_still(world);
  drive.fingers.fill({0.4, 1.0, 0.9});
  return drive;
}

/// World after two seconds of gripping the block.
World gripped(double friction, const ContactParameters& contact) {
  World world(gripped_block(friction), rigid_arm(), contact);
  world.flexion_rad.fill(0.6);
  place_above(world, {0.015, 0.0, 0.0}, 0.0);
  run(world, gripping_drive(world), 2.0, 0.001);
  return world;
}

/// Sets the hand's motion with acceleration `peak` cos(rate t) from rest; the acceleration is the
/// mean over the step that begins at `time_s`.
void shake(Drive& drive, double peak, double rate, double time_s, double step_s) {
  const auto speed = [&](double t) { return peak / rate * std::sin(rate * t); };
  drive.position_m = peak / (rate * rate) * (1.0 - std::cos(rate * time_s)) * shaken_along;
  drive.velocity_m_per_s = speed(time_s) * shaken_along;
  drive.acceleration_m_per_s2 = (speed(time_s + step_s) - speed(time_s)) / step_s * shaken_along;
}

/// The same grip with all friction springs relaxed and without slip from then on.
World without_slip(const World& closed, const ContactParameters& contact) {
  World world(gripped_block(no_slip), rigid_arm(), contact);
  world.object.position_m = closed.object.position_m;
  world.object.orientation = closed.object.orientation;
  world.flexion_rad = closed.flexion_rad;
  return world;
}

}  // namespace

double standing_rod_error(double height_m, double step_s) {
  const ContactParameters contact = linear_springs(0.0);
  World world = standing_rod(height_m, contact);
  SmallDisplacement push = SmallDisplacement::Zero();
  push.segment<3>(small_turn) = Vector3d(0.5e-4, 1e-4, 0.0);
  world.object.angular_velocity_rad_per_s = push.segment<3>(small_turn);
  const Drive drive = hold_still(world);
  const Vector3d expected = SmallOscillations(world, FirstContacts(world), drive, contact)
                                .free(push, 1.0)
                                .segment<3>(small_turn);
  run(world, drive, 1.0, step_s);
  const Eigen::AngleAxisd turn(world.object.orientation);
  return (turn.angle() * turn.axis() - expected).norm() / expected.norm();
}

double grip_response_error(double step_s) {
  const ContactParameters contact = linear_springs(3.0);
  constexpr double peak = 0.01, period_s = 0.048, rate = 2.0 * std::numbers::pi / period_s;
  World world = without_slip(gripped(0.7, contact), contact);
  Drive drive = gripping_drive(world);
  FirstContacts contacts(world);
  for (int i = 0; i < 2000; ++i) {
    world.step(drive, 0.001);
    contacts.update(world);
  }
  const SmallOscillations theory(world, contacts, drive, contact);
  const Vector3d rest = world.object.position_m - world.hand.position_m;
  const long cycle = std::lround(period_s / step_s), settling = 30 * cycle, measured = 10 * cycle;
  Eigen::Vector3cd response = Eigen::Vector3cd::Zero();
  for (long i = 0; i < settling + measured; ++i) {
    shake(drive, peak, rate, static_cast<double>(i) * step_s, step_s);
    world.step(drive, step_s);
    if (i < settling) continue;
    const Vector3d moved = world.object.position_m - world.hand.position_m - rest;
    const double phase = rate * static_cast<double>(i + 1) * step_s;
    response += 2.0 / static_cast<double>(measured) / peak * std::polar(1.0, -phase) * moved;
  }
  const Eigen::Vector3cd expected = theory.response(shaken_along, rate);
  return (response - expected).norm() / expected.norm();
}

double gripped_force_error(double step_s) {
  constexpr double rate = 4.0 * std::numbers::pi, peak = 0.03 * rate * rate;
  World world = gripped(0.7, {});
  const double mass_kg = world.spec().mass_kg;
  Drive drive = gripping_drive(world);
  MaxError worst;
  for (long i = 0; i < std::lround(1.5 / step_s); ++i) {
    const double time_s = static_cast<double>(i) * step_s;
    shake(drive, peak, rate, time_s, step_s);
    world.step(drive, step_s);
    if (time_s < 0.5) continue;
    const Vector3d load =
        mass_kg * (gravity_m_per_s2 * Vector3d::UnitZ() +
                   peak * std::cos(rate * (time_s + 0.5 * step_s)) * shaken_along);
    worst.add((world.force_on_object_n() - load).norm() / (mass_kg * gravity_m_per_s2));
  }
  return worst.value;
}

}  // namespace touchtrace::scene
