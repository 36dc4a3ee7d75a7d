#include <algorithm>
#include <cmath>

#include "tests/verify/scene/laboratory.h"
#include "tests/verify/scene/precision.h"

namespace touchtrace::scene {
namespace {

struct Extreme {
  double mass_kg, stiffer, friction, step_s;
};

template <typename Visit>
void for_each_extreme(const Visit& visit) {
  for (double mass_kg : {0.005, 0.1, 1.0, 10.0})
    for (double stiffer : {0.01, 1.0, 100.0})
      for (double friction : {0.0, 0.7, 2.0})
        for (double step_s : {0.0001, 0.001, 0.002, 0.005, 0.007, 0.010})
          visit(Extreme{mass_kg, stiffer, friction, step_s});
}

ContactParameters contact_of(const Extreme& extreme) {
  ContactParameters contact;
  contact.stiffness_n_per_m3 *= extreme.stiffer;
  return contact;
}

/// Energy gained in an impact at 10 m/s, against the energy before.
double impact_gain(const Extreme& extreme) {
  World world(sphere(extreme.mass_kg, extreme.friction, 0.03), stand(), contact_of(extreme));
  put_above(world, {0.0, 0.005, 0.0}, 0.001);
  world.object.velocity_m_per_s = {0.5, 0.0, -10.0};
  const Drive drive = keep_still(world);
  const double before = energy_j(world);
  double most = before;
  for (double t = 0.0; t < 0.05; t += extreme.step_s) {
    world.advance(drive, extreme.step_s, extreme.step_s);
    if (!finite(world)) return std::nan("");
    most = std::max(most, energy_j(world));
  }
  return most / before - 1.0;
}

/// What the palm bears before the deepest indentation that the law is meant for.
bool bears(const Extreme& extreme) {
  ContactParameters contact = contact_of(extreme);
  World world(block(extreme.mass_kg, 0.7, {0.025, 0.03, 0.02}), stand(), contact);
  put_above(world, {0.01, 0.0, 0.0}, 0.0);
  world.object.position_m.z() -= 0.5 * contact.clamp_m;
  world.step(keep_still(world), 1e-7);
  return world.force_on_object_n().z() > extreme.mass_kg * gravity_m_per_s2;
}

double resting_error_of(const Extreme& e) {
  return std::abs(resting_force_ratio(e.mass_kg, e.step_s, 3.0, contact_of(e), e.friction) - 1.0);
}

struct Grip {
  double force_n, mass_kg, stiffer, step_s;
};

/// Speed left after 1.5 s of a closed grip around a block by a hand that stands still.
double gripped_speed_m_per_s(const Grip& grip) {
  constexpr double lever_m = 0.05;
  ContactParameters contact;
  contact.stiffness_n_per_m3 *= grip.stiffer;
  World world(block(grip.mass_kg, 0.7, {0.02, 0.045, 0.02}), stand(), contact);
  world.flexion_rad.fill(0.6);
  put_above(world, {0.015, 0.0, 0.0}, 0.0);
  Drive drive = keep_still(world);
  drive.carried_weight_n = grip.mass_kg * gravity_m_per_s2;
  drive.fingers.fill({grip.force_n * lever_m / finger_count, 1.0, 0.9});
  for (double t = 0.0; t < 1.5; t += grip.step_s) world.advance(drive, grip.step_s, grip.step_s);
  return world.object.velocity_m_per_s.norm();
}

}  // namespace

void verify_extremes(const std::function<void(Figure)>& emit) {
  Worst gain, resting, gripped;
  for_each_extreme([&](const Extreme& extreme) {
    gain.add(impact_gain(extreme));
    // Without friction nothing comes to rest on a dish.
    if (extreme.friction > 0.0 && bears(extreme)) resting.add(resting_error_of(extreme));
  });
  for (double force_n : {1.0, 10.0, 60.0})
    for (double mass_kg : {0.005, 0.3, 10.0})
      for (double stiffer : {0.01, 0.1, 1.0, 100.0})
        for (double step_s : {0.0001, 0.001, 0.010})
          if (bears({mass_kg, stiffer, 0.7, step_s}))
            gripped.add(gripped_speed_m_per_s({force_n, mass_kg, stiffer, step_s}));
  emit(at_most("extreme impacts at 10 m/s: energy gained", gain.value, "", 1e-3));
  emit(at_most("extreme blocks at rest: force / weight - 1", resting.value, "", 1e-3));
  emit(at_most("extreme grips, 1 to 60 N: speed left", gripped.value, "m/s", 1e-2));
}

}  // namespace touchtrace::scene
