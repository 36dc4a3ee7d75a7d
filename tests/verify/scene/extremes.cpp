#include <algorithm>
#include <cmath>

#include "tests/verify/scene/setups.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {
namespace {

struct Extreme {
  double mass_kg, stiffness_factor, friction, step_s;
};

template <typename Visit>
void for_each_extreme(const Visit& visit) {
  for (double mass_kg : {0.005, 0.1, 1.0, 10.0})
    for (double stiffness_factor : {0.01, 1.0, 100.0})
      for (double friction : {0.0, 0.7, 2.0})
        for (double step_s : {0.0001, 0.001, 0.002, 0.005, 0.007, 0.010})
          visit(Extreme{mass_kg, stiffness_factor, friction, step_s});
}

ContactParameters contact_of(const Extreme& extreme) {
  ContactParameters contact;
  contact.stiffness_n_per_m3 *= extreme.stiffness_factor;
  return contact;
}

/// Relative energy gain in an impact at 10 m/s.
double impact_gain(const Extreme& extreme) {
  World world(sphere(extreme.mass_kg, extreme.friction, 0.03), rigid_arm(), contact_of(extreme));
  place_above(world, {0.0, 0.005, 0.0}, 0.001);
  world.object.velocity_m_per_s = {0.5, 0.0, -10.0};
  const Drive drive = hold_still(world);
  const double before = energy_j(world);
  double highest = before;
  for (double t = 0.0; t < 0.05; t += extreme.step_s) {
    world.advance(drive, extreme.step_s, extreme.step_s);
    if (!is_finite(world)) return std::nan("");
    highest = std::max(highest, energy_j(world));
  }
  return highest / before - 1.0;
}

/// Whether the palm supports the block at less than max_depth_m.
bool is_supported(const Extreme& extreme) {
  ContactParameters contact = contact_of(extreme);
  World world(block(extreme.mass_kg, 0.7, {0.025, 0.03, 0.02}), rigid_arm(), contact);
  place_above(world, {0.01, 0.0, 0.0}, 0.0);
  world.object.position_m.z() -= 0.5 * contact.max_depth_m;
  world.step(hold_still(world), 1e-7);
  return world.force_on_object_n().z() > extreme.mass_kg * gravity_m_per_s2;
}

double resting_error_of(const Extreme& e) {
  return std::abs(resting_force_ratio(e.mass_kg, e.step_s, 3.0, contact_of(e), e.friction) - 1.0);
}

struct Grip {
  double force_n, mass_kg, stiffness_factor, step_s;
};

/// Speed of a block after 1.5 s in the closed grip of a hand that stands still.
double gripped_speed_m_per_s(const Grip& grip) {
  constexpr double lever_m = 0.05;
  ContactParameters contact;
  contact.stiffness_n_per_m3 *= grip.stiffness_factor;
  World world(block(grip.mass_kg, 0.7, {0.02, 0.045, 0.02}), rigid_arm(), contact);
  world.flexion_rad.fill(0.6);
  place_above(world, {0.015, 0.0, 0.0}, 0.0);
  Drive drive = hold_still(world);
  drive.carried_weight_n = grip.mass_kg * gravity_m_per_s2;
  drive.fingers.fill({grip.force_n * lever_m / num_fingers, 1.0, 0.9});
  for (double t = 0.0; t < 1.5; t += grip.step_s) world.advance(drive, grip.step_s, grip.step_s);
  return world.object.velocity_m_per_s.norm();
}

}  // namespace

void verify_extremes(const std::function<void(Figure)>& emit) {
  MaxError gain, resting, gripped;
  for_each_extreme([&](const Extreme& extreme) {
    gain.add(impact_gain(extreme));
    // Without friction a block slides on the dish forever.
    if (extreme.friction > 0.0 && is_supported(extreme)) resting.add(resting_error_of(extreme));
  });
  for (double force_n : {1.0, 10.0, 60.0})
    for (double mass_kg : {0.005, 0.3, 10.0})
      for (double stiffness_factor : {0.01, 0.1, 1.0, 100.0})
        for (double step_s : {0.0001, 0.001, 0.010})
          if (is_supported({mass_kg, stiffness_factor, 0.7, step_s}))
            gripped.add(gripped_speed_m_per_s({force_n, mass_kg, stiffness_factor, step_s}));
  emit(at_most("extreme impacts at 10 m/s: relative energy gain", gain.value, "", 1e-3));
  emit(at_most("extreme blocks at rest: force / weight - 1", resting.value, "", 1e-3));
  emit(at_most("extreme grips, 1 to 60 N: residual speed", gripped.value, "m/s", 1e-2));
}

}  // namespace touchtrace::scene
