#include "tests/verify/scene/ball_closed_forms.h"

#include <cmath>

#include "tests/verify/scene/setups.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double drop_m = 0.30;

double ballistic_rate_per_s(const Ball& ball) {
  return std::sqrt(gravity_m_per_s2 * drag_per_m(ball));
}

void fly_for(const Ball& ball, RigidState& state, double seconds, double step_s) {
  const long steps = std::lround(seconds / step_s);
  for (long i = 0; i < steps; ++i) fly(ball, state, step_s);
}

/// With drag k v^2 the distance of a fall from rest is ln(cosh(sqrt(g k) t)) / k.
double fall_error_m(double step_s) {
  const Ball ball;
  RigidState state;
  fly_for(ball, state, 1.0, step_s);
  const double fallen = std::log(std::cosh(ballistic_rate_per_s(ball))) / drag_per_m(ball);
  return std::abs(-state.position_m.z() - fallen);
}

double oblique_error_m(double step_s) {
  const Ball ball;
  RigidState state, reference;
  state.velocity_m_per_s = reference.velocity_m_per_s = {3.0, 1.0, 4.0};
  fly_for(ball, state, 0.8, step_s);
  fly_for(ball, reference, 0.8, step_s / 100);
  return (state.position_m - reference.position_m).norm();
}

/// Apex after the first bounce of a ball that falls on an immovable plate.
double apex_m(const ObjectSpec& object, double step_s) {
  const double surface_m = object.solids.front().size_m.z() + object.ball->radius_m;
  RigidState held, ball;
  ball.position_m.z() = surface_m + drop_m;
  bool has_bounced = false;
  double highest = 0.0;
  while (!has_bounced || ball.velocity_m_per_s.z() > 0.0) {
    const double h = has_bounced ? step_s : contact_free_time_s(object, held, ball, step_s);
    fly(*object.ball, ball, std::max(h, 1e-9));
    if (!has_bounced)
      has_bounced = bounce(object, object.ball->restitution, held, ball).has_value();
    const double rise = ball.velocity_m_per_s.z();  // of the last step, a parabola
    highest = ball.position_m.z() + 0.5 * rise * rise / gravity_m_per_s2 * (rise < 0.0);
  }
  return highest - surface_m;
}

double vacuum_bounce_error(double step_s) {
  ObjectSpec object = plate(1e9);
  object.ball->drag_coefficient = 0.0;
  const double e = object.ball->restitution;
  return std::abs(apex_m(object, step_s) / (e * e * drop_m) - 1.0);
}

/// A fall of h through air ends at v^2 = g (1 - exp(-2 k h)) / k; a ball that starts at v rises by
/// ln(1 + k v^2 / g) / (2 k).
double bounce_in_air_error(double step_s) {
  const ObjectSpec object = plate(1e9);
  const double e = object.ball->restitution, k = drag_per_m(*object.ball);
  const double expected = std::log1p(-e * e * std::expm1(-2 * k * drop_m)) / (2 * k);
  return std::abs(apex_m(object, step_s) / expected - 1.0);
}

/// A ball on a plate, just before an impact.
struct ImpactSetup {
  ObjectSpec object;
  RigidState held, ball;

  ImpactSetup(double plate_kg, const Vector3d& velocity, const Vector3d& spin, double friction)
      : object(plate(plate_kg)) {
    object.ball->friction = friction;
    ball.position_m.z() = object.solids.front().size_m.z() + object.ball->radius_m;
    ball.velocity_m_per_s = velocity;
    ball.angular_velocity_rad_per_s = spin;
  }
  void collide() { bounce(object, object.ball->restitution, held, ball); }
  double kinetic_j() const { return kinetic_energy_j(object, held, ball); }
};

/// An impact loses (1 - e^2) of the kinetic energy of the reduced mass.
double energy_error(double) {
  ImpactSetup setup(0.17, {0.0, 0.0, -2.5}, Vector3d::Zero(), 0.6);
  const Ball& b = *setup.object.ball;
  const double before = setup.kinetic_j();
  setup.collide();
  const double reduced_kg = 1.0 / (1.0 / b.mass_kg + 1.0 / setup.object.mass_kg);
  const double expected = 0.5 * reduced_kg * 2.5 * 2.5 * (1.0 - b.restitution * b.restitution);
  return std::abs((before - setup.kinetic_j()) / expected - 1.0);
}

/// After an impact that ends rolling, a hollow sphere keeps 3/5 of the slip speed, and its spin is
/// that of rolling.
double rolling_error(double) {
  const double slip = 1.0;
  ImpactSetup setup(1e9, {slip, 0.0, -2.5}, Vector3d::Zero(), 10.0);
  setup.collide();
  const double radius_m = setup.object.ball->radius_m;
  return std::abs(setup.ball.velocity_m_per_s.x() - 0.6 * slip) +
         std::abs(setup.ball.angular_velocity_rad_per_s.y() * radius_m - 0.6 * slip);
}

/// In an impact that ends sliding, friction reduces the slip speed by mu (1 + e) v and changes the
/// surface speed of the spin by 3/2 of that.
double sliding_spin_error(double) {
  const double slip = 4.0, fall = 1.0, friction = 0.3;
  ImpactSetup setup(1e9, {slip, 0.0, -fall}, Vector3d::Zero(), friction);
  setup.collide();
  const Ball& b = *setup.object.ball;
  const double taken = friction * (1.0 + b.restitution) * fall;
  return std::abs(setup.ball.velocity_m_per_s.x() - (slip - taken)) +
         std::abs(setup.ball.angular_velocity_rad_per_s.y() * b.radius_m - 1.5 * taken);
}

/// Total momentum and angular momentum about the origin are conserved; impact 6 cm off the centre.
double momentum_error(double) {
  ImpactSetup setup(0.17, {0.5, -0.3, -2.5}, {3.0, -20.0, 7.0}, 0.6);
  setup.ball.position_m += Vector3d(0.03, -0.05, 0.0);
  const Ball& b = *setup.object.ball;
  const double inertia = 2.0 / 3.0 * b.mass_kg * b.radius_m * b.radius_m;
  const auto momentum = [&] {
    const RigidState &ball = setup.ball, &held = setup.held;
    Eigen::Matrix<double, 6, 1> sum;
    sum << b.mass_kg * ball.velocity_m_per_s + setup.object.mass_kg * held.velocity_m_per_s,
        b.mass_kg * ball.position_m.cross(ball.velocity_m_per_s) +
            inertia * ball.angular_velocity_rad_per_s +
            setup.object.inertia_kg_m2 * held.angular_velocity_rad_per_s;
    return sum;
  };
  const auto before = momentum();
  setup.collide();
  return (momentum() - before).norm() / before.norm();
}

/// Two bodies in free fall meet as without gravity.
double time_of_impact_error_s(double step_s) {
  ObjectSpec object = plate(1e6);
  object.ball->drag_coefficient = 0.0;
  World world(object, rigid_arm());
  world.object.position_m = {10.0, 0.0, 10.0};
  world.ball = RigidState{};
  const double gap_m = 0.01234, speed = 2.5;
  const double surface_m = object.solids.front().size_m.z() + object.ball->radius_m;
  world.ball->position_m = world.object.position_m + Vector3d(0.0, 0.0, surface_m + gap_m);
  world.ball->velocity_m_per_s.z() = -speed;
  world.advance(hold_still(world), 0.02, step_s);
  if (world.impacts().size() != 1) return 1.0;
  return std::abs(world.impacts().front().after_s - gap_m / speed);
}

}  // namespace

double kinetic_energy_j(const ObjectSpec& object, const RigidState& held, const RigidState& ball) {
  const Ball& b = *object.ball;
  const Vector3d w = held.orientation.conjugate() * held.angular_velocity_rad_per_s;
  const double inertia = 2.0 / 3.0 * b.mass_kg * b.radius_m * b.radius_m;
  return 0.5 *
         (b.mass_kg * ball.velocity_m_per_s.squaredNorm() +
          inertia * ball.angular_velocity_rad_per_s.squaredNorm() +
          object.mass_kg * held.velocity_m_per_s.squaredNorm() + w.dot(object.inertia_kg_m2 * w));
}

ObjectSpec plate(double mass_kg) {
  ObjectSpec object = block(mass_kg, 0.7, {0.1, 0.1, 0.01});
  object.ball = Ball{};
  return object;
}

const std::vector<ClosedForm>& ball_closed_forms() {
  static const std::vector<ClosedForm> table{
      {"ball falling through air, 1 s", "m", 0.05, 1e-5, 3.8, fall_error_m},
      {"ball flying through air, against a hundredth of the step", "m", 0.05, 1e-5, 3.8,
       oblique_error_m},
      {"ball in vacuum, height after a bounce", "", 0.002, 1e-8, 0.0, vacuum_bounce_error},
      {"ball in air, height after a bounce", "", 0.002, 1e-8, 0.0, bounce_in_air_error},
      {"time of an impact within a step", "s", 0.002, 2e-7, 0.0, time_of_impact_error_s},
      {"impact, energy lost / (1 - e^2)", "", 0.002, 1e-12, 0.0, energy_error},
      {"impact that ends rolling, speed and spin", "m/s", 0.002, 1e-6, 0.0, rolling_error},
      {"impact that ends sliding, speed and spin", "m/s", 0.002, 1e-6, 0.0, sliding_spin_error},
      {"impact, momentum and angular momentum of both", "", 0.002, 1e-13, 0.0, momentum_error},
  };
  return table;
}

}  // namespace touchtrace::scene
