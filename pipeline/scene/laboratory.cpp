#include "pipeline/scene/laboratory.h"

#include "pipeline/scene/solids.h"

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

ArmParameters stand() { return {1000.0, 1e7, 1.0, 1e9}; }

Drive keep_still(const World& world) {
  Drive drive;
  drive.position_m = world.hand.position_m;
  for (int i = 0; i < finger_count; ++i) drive.fingers[i] = {0.0, 1e3, world.flexion_rad[i]};
  return drive;
}

void put_above(World& world, const Vector3d& place_m, double gap_m) {
  world.object = {};
  double height = 0.0;
  for (bool free = false; !free; height += 1e-5) {
    free = true;
    for (const Taxel& taxel : hand_model().taxels)
      if (taxel.finger < 0)
        free &=
            distance_m(world.spec(), taxel.position_m - place_m - height * Vector3d::UnitZ()) > 0;
  }
  const Vector3d above = place_m + (height + gap_m) * Vector3d::UnitZ();
  world.object.position_m = world.hand.position_m + world.hand.orientation * above;
  world.object.orientation = world.hand.orientation;
}

double resting_force_ratio(double mass_kg, double step_s, double seconds) {
  World world(block(mass_kg, 0.7, {0.025, 0.03, 0.02}), stand());
  put_above(world, {0.01, 0.0, 0.0}, 0.001);
  const Drive drive = keep_still(world);
  for (double t = 0.0; t < seconds; t += step_s) world.step(drive, step_s);
  return world.force_on_object_n().z() / (mass_kg * gravity_m_per_s2);
}

double free_flight_error_m(double step_s) {
  World world(sphere(0.2, 0.7, 0.03), stand());
  world.object.position_m = {10.0, 0.0, 10.0};
  world.object.velocity_m_per_s = {1.0, -2.0, 2.0};
  world.object.angular_velocity_rad_per_s = {3.0, 1.0, -2.0};
  const Vector3d expected = world.object.position_m + world.object.velocity_m_per_s -
                            0.5 * gravity_m_per_s2 * Vector3d::UnitZ();
  const Drive drive = keep_still(world);
  const long steps = std::lround(1.0 / step_s);
  for (long i = 0; i < steps; ++i) world.step(drive, step_s);
  return (world.object.position_m - expected).norm();
}

}  // namespace touchtrace::scene
