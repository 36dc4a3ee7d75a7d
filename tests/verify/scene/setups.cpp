#include "tests/verify/scene/setups.h"

#include <cmath>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {

using Eigen::Vector3d;

ObjectSpec block(double mass_kg, double friction, const Vector3d& half_m) {
  const Vector3d moments =
      mass_kg / 3 * (Vector3d::Constant(half_m.squaredNorm()) - half_m.cwiseAbs2());
  return {"block", mass_kg, friction, moments.asDiagonal(), {Solid{ShapeKind::box, half_m}}};
}

ObjectSpec sphere(double mass_kg, double friction, double radius_m) {
  const double moment = 0.4 * mass_kg * radius_m * radius_m;
  return {"sphere",
          mass_kg,
          friction,
          moment * Eigen::Matrix3d::Identity(),
          {Solid{ShapeKind::sphere, {radius_m, 0.0, 0.0}}}};
}

ObjectSpec sled(double mass_kg, double friction) {
  ObjectSpec object = block(mass_kg, friction, {0.0225, 0.06, 0.02});
  object.inertia_kg_m2 = 1e6 * Eigen::Matrix3d::Identity();
  return object;
}

ArmParameters rigid_arm() { return {1e6, 1e10, 1.0, 1e12}; }

Drive hold_still(const World& world) {
  Drive drive;
  drive.position_m = world.hand.position_m;
  for (int i = 0; i < num_fingers; ++i) drive.fingers[i] = {0.0, 1e3, world.flexion_rad[i]};
  return drive;
}

void place_above(World& world, const Vector3d& place_m, double gap_m) {
  world.object = {};
  double height = 0.0;
  for (bool is_clear = false; !is_clear; height += 1e-5) {
    is_clear = true;
    for (const Taxel& taxel : world.model().taxels)
      if (taxel.finger < 0)
        is_clear &=
            distance_m(world.spec(), taxel.position_m - place_m - height * Vector3d::UnitZ()) > 0;
  }
  const Vector3d above = place_m + (height + gap_m) * Vector3d::UnitZ();
  world.object.position_m = world.hand.position_m + world.hand.orientation * above;
  world.object.orientation = world.hand.orientation;
}

void run(World& world, const Drive& drive, double seconds, double step_s) {
  const long steps = std::lround(seconds / step_s);
  for (long i = 0; i < steps; ++i) world.step(drive, step_s);
}

double energy_j(const World& world) {
  const ObjectSpec& spec = world.spec();
  const Vector3d spin =
      world.object.orientation.conjugate() * world.object.angular_velocity_rad_per_s;
  return spec.mass_kg * (0.5 * world.object.velocity_m_per_s.squaredNorm() +
                         gravity_m_per_s2 * world.object.position_m.z()) +
         0.5 * spin.dot(spec.inertia_kg_m2 * spin);
}

bool is_finite(const World& world) {
  return world.object.position_m.allFinite() && world.object.velocity_m_per_s.allFinite() &&
         world.object.angular_velocity_rad_per_s.allFinite() && world.hand.position_m.allFinite() &&
         world.force_on_object_n().allFinite();
}

double resting_force_ratio(double mass_kg, double step_s, double seconds,
                           const ContactParameters& contact, double friction) {
  World world(block(mass_kg, friction, {0.025, 0.03, 0.02}), rigid_arm(), contact);
  place_above(world, {0.01, 0.0, 0.0}, 0.001);
  const Drive drive = hold_still(world);
  for (double t = 0.0; t < seconds; t += step_s) world.advance(drive, step_s, step_s);
  return world.mean_force_n().z() / (mass_kg * gravity_m_per_s2);
}

double closed_form_restitution(double c, double v) {
  if (c == 0.0) return 1.0;
  const double loaded = v / c - std::log1p(c * v) / (c * c);
  double low = 0.0, high = std::min(v, 1.0 / c);
  for (int i = 0; i < 200; ++i) {
    const double u = 0.5 * (low + high);
    (-u / c - std::log1p(-c * u) / (c * c) < loaded ? low : high) = u;
  }
  return low / v;
}

}  // namespace touchtrace::scene
