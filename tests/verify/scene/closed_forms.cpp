#include "tests/verify/scene/closed_forms.h"

#include <array>
#include <cmath>
#include <numbers>

#include "tests/verify/scene/grip_closed_forms.h"
#include "tests/verify/scene/setups.h"

namespace touchtrace::scene {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double far_m = 10.0;  // from the hand

World in_flight(const Vector3d& moments, const Vector3d& spin) {
  ObjectSpec object = block(0.2, 0.7, {0.02, 0.03, 0.05});
  object.inertia_kg_m2 = moments.asDiagonal();
  World world(object, rigid_arm());
  world.object.position_m = {far_m, 0.0, far_m};
  world.object.velocity_m_per_s = {1.0, -2.0, 2.0};
  world.object.angular_velocity_rad_per_s = spin;
  return world;
}

double flight_error_m(double step_s) {
  World world = in_flight({3e-4, 2e-4, 1e-4}, {3.0, 1.0, -2.0});
  const Vector3d expected = world.object.position_m + world.object.velocity_m_per_s -
                            0.5 * gravity_m_per_s2 * Vector3d::UnitZ();
  run(world, hold_still(world), 1.0, step_s);
  return (world.object.position_m - expected).norm();
}

/// A symmetric top rotates about its angular momentum at |L| / I1 and about its axis at
/// w3 (1 - I3 / I1).
double symmetric_top_error_rad(double step_s) {
  const Vector3d moments(3e-4, 3e-4, 1e-4), spin(2.0, 1.0, 10.0);
  World world = in_flight(moments, spin);
  run(world, hold_still(world), 1.0, step_s);
  const Vector3d momentum = moments.cwiseProduct(spin);
  const double about_axis = spin.z() * (1.0 - moments.z() / moments.x());
  const Eigen::Quaterniond expected =
      AngleAxisd(momentum.norm() / moments.x(), momentum.normalized()) *
      AngleAxisd(about_axis, Vector3d::UnitZ());
  return world.object.orientation.angularDistance(expected);
}

/// sn, cn, dn of Jacobi by descending Landen transformations (Abramowitz and Stegun 16.4).
std::array<double, 3> jacobi(double u, double parameter) {
  std::array<double, 12> a{1.0}, c{std::sqrt(parameter)};
  double b = std::sqrt(1.0 - parameter), scale = 1.0;
  std::size_t n = 0;
  for (; n + 1 < a.size() && c[n] > 1e-15; ++n, scale *= 2.0) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
  }
  double phi = scale * a[n] * u;
  for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
  const double sn = std::sin(phi);
  return {sn, std::cos(phi), std::sqrt(1.0 - parameter * sn * sn)};
}

/// Angular velocity in the body frame against Landau and Lifshitz, Mechanics, (37.10).
double asymmetric_top_error_rad_per_s(double step_s) {
  const Vector3d moments(1e-4, 2e-4, 3e-4), spin(4.0, 0.0, 6.0);
  World world = in_flight(moments, spin);
  run(world, hold_still(world), 1.0, step_s);
  const auto [i1, i2, i3] = std::array{moments.x(), moments.y(), moments.z()};
  const double energy2 = spin.dot(moments.cwiseProduct(spin));
  const double momentum2 = moments.cwiseProduct(spin).squaredNorm();
  const double rate = std::sqrt((i3 - i2) * (momentum2 - energy2 * i1) / (i1 * i2 * i3));
  const double parameter =
      (i2 - i1) * (energy2 * i3 - momentum2) / ((i3 - i2) * (momentum2 - energy2 * i1));
  const auto [sn, cn, dn] = jacobi(rate, parameter);
  const double middle = std::sqrt((energy2 * i3 - momentum2) / (i2 * (i3 - i2)));
  const Vector3d expected(spin.x() * cn, middle * sn, spin.z() * dn);
  const auto& turned = world.object;
  return (turned.orientation.conjugate() * turned.angular_velocity_rad_per_s - expected).norm();
}

/// Bounce off a vertical palm, so that gravity does no work.
double bounce_error(double dissipation_s_per_m, double step_s) {
  const double speed = 0.1;
  ContactParameters contact;
  contact.dissipation_s_per_m = dissipation_s_per_m;
  World world(sled(0.05, 0.0), rigid_arm(), contact);
  world.hand.orientation = AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX());
  place_above(world, sled_place_m, 1e-4);
  const Vector3d away = world.hand.orientation * Vector3d::UnitZ();
  world.object.velocity_m_per_s = -speed * away;
  run(world, hold_still(world), 0.03, step_s);
  return std::abs(world.object.velocity_m_per_s.dot(away) / speed -
                  closed_form_restitution(dissipation_s_per_m, speed));
}

/// Damped oscillator: the arm, released 5 cm from its commanded position.
double oscillator_error_m(double step_s) {
  const ArmParameters arm{2.0, 300.0, 0.1, 1e9};
  World world(sphere(0.1, 0.7, 0.02), arm);
  world.object.position_m = {far_m, 0.0, far_m};
  const Drive drive = hold_still(world);
  world.hand.position_m.x() = 0.05;
  run(world, drive, 1.0, step_s);
  const double rate = std::sqrt(arm.stiffness_n_per_m / arm.mass_kg), zeta = arm.damping_ratio,
               damped = rate * std::sqrt(1.0 - zeta * zeta);
  const double expected =
      0.05 * std::exp(-zeta * rate) * (std::cos(damped) + zeta * rate / damped * std::sin(damped));
  return std::abs(world.hand.position_m.x() - expected);
}

World on_slope(double slope, double friction) {
  World world(sled(0.2, friction), rigid_arm());
  world.hand.orientation = AngleAxisd(std::atan(slope), Vector3d::UnitX());
  place_above(world, sled_place_m, 1e-5);
  return world;
}

/// Below the angle of friction the block stops.
double sticking_speed_m_per_s(double step_s) {
  World world = on_slope(0.3, 0.5);
  run(world, hold_still(world), 3.0, step_s);
  return world.object.velocity_m_per_s.norm();
}

/// Above the angle of friction the tangential force is mu times the normal force.
double sliding_error(double step_s) {
  const double friction = 0.5, slope = 0.8;
  World world = on_slope(slope, friction);
  const Drive drive = hold_still(world);
  run(world, drive, 0.04, step_s);
  const Vector3d normal = world.object.orientation * Vector3d::UnitZ();
  const Vector3d before = world.object.velocity_m_per_s;
  run(world, drive, 0.02, step_s);
  const Vector3d change = world.object.velocity_m_per_s - before +
                          0.02 * gravity_m_per_s2 * Vector3d::UnitZ();  // by the hand
  const double along = (change - normal * normal.dot(change)).norm();
  return std::abs(along / (friction * normal.dot(change)) - 1.0);
}

double resting_error(double step_s) {
  return std::abs(resting_force_ratio(0.17, step_s, 3.0) - 1.0);
}

/// A palm shaken along its normal carries m (g + a), up to the relative compliance
/// (rate / natural rate)^2, which stiff contacts make small.
double shaking_error(double step_s) {
  const double rate = 4.0 * std::numbers::pi, amplitude_m = 0.03, mass_kg = 0.17;
  ContactParameters stiff;
  stiff.stiffness_n_per_m3 *= 100.0;
  World world(sled(mass_kg, 0.7), rigid_arm(), stiff);
  place_above(world, sled_place_m, 0.0);
  Drive drive = hold_still(world);
  MaxError worst;
  for (double t = 0.0; t < 2.0 - 0.5 * step_s; t += step_s) {
    const double start_s = std::max(0.0, t - 0.5);  // at rest until it has settled
    const double z = amplitude_m * (1.0 - std::cos(rate * start_s)),
                 speed = amplitude_m * rate * std::sin(rate * start_s),
                 push = t < 0.5 ? 0.0 : amplitude_m * rate * rate * std::cos(rate * start_s);
    drive.position_m.z() = z, drive.velocity_m_per_s.z() = speed;
    drive.acceleration_m_per_s2.z() = push;
    world.step(drive, step_s);
    const double middle_s = start_s + 0.5 * step_s;
    const double expected =
        gravity_m_per_s2 + amplitude_m * rate * rate * std::cos(rate * middle_s);
    if (t > 1.0) worst.add(std::abs(world.force_on_object_n().z() / (mass_kg * expected) - 1.0));
  }
  return worst.value;
}

}  // namespace

const std::vector<ClosedForm>& closed_forms() {
  static const std::vector<ClosedForm> table{
      {"free flight of 1 s, position", "m", 0.002, 1e-10, 0.0, flight_error_m},
      {"spin of a symmetric top, 1 s", "rad", 0.002, 1e-3, 1.9, symmetric_top_error_rad},
      {"tumbling of an asymmetric top, 1 s", "rad/s", 0.002, 1e-2, 1.9,
       asymmetric_top_error_rad_per_s},
      {"arm released 5 cm off, 1 s", "m", 0.002, 1e-4, 1.9, oscillator_error_m},
      {"elastic bounce, restitution", "", 0.0005, 0.02, 1.7,
       [](double h) { return bounce_error(0.0, h); }},
      {"damped bounce, restitution", "", 0.0005, 0.02, 1.7,
       [](double h) { return bounce_error(9.0, h); }},
      {"block on a slope below the angle of friction, speed", "m/s", 0.002, 1e-6, 0.0,
       sticking_speed_m_per_s},
      {"block sliding down a slope, friction / (mu N)", "", 0.002, 0.01, 1.9, sliding_error},
      {"block at rest, force / weight", "", 0.002, 1e-3, 0.0, resting_error},
      {"block shaken at 2 Hz, force / (m (g + a))", "", 0.002, 0.01, 0.0, shaking_error},
      {"rod rocking on its flat foot, tilt after 1 s", "", 0.002, 1e-3, 1.9,
       [](double h) { return standing_rod_error(0.1, h); }},
      {"rod falling from its flat foot, tilt after 1 s", "", 0.002, 5e-3, 1.9,
       [](double h) { return standing_rod_error(0.4, h); }},
      {"block in a closed grip shaken at 21 Hz, amplitude and phase", "", 0.002, 0.02, 1.5,
       grip_response_error},
      {"block in a closed grip shaken at 2 Hz, force / (m (g + a))", "", 0.002, 0.01, 0.0,
       gripped_force_error},
  };
  return table;
}

Picture::Curve convergence(const ClosedForm& form) {
  Picture::Curve curve{"largest step and halves", {}, {}};
  for (const double share : {1.0, 0.5, 0.25, 0.125}) {
    curve.x.push_back(share * form.step_s);
    curve.y.push_back(form.error(curve.x.back()));
  }
  return curve;
}

double order_of_convergence(const Picture::Curve& convergence) {
  const Eigen::Map<const Eigen::ArrayXd> steps(convergence.x.data(), convergence.x.size()),
      errors(convergence.y.data(), convergence.y.size());
  const Eigen::ArrayXd x = steps.log() - steps.log().mean();
  return (x * errors.log()).sum() / x.square().sum();
}

}  // namespace touchtrace::scene
