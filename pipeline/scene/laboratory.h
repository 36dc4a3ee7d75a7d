#pragma once

#include "pipeline/scene/world.h"

namespace touchtrace::scene {

/// Set-ups with closed forms, for tests and for `touchtrace verify scene`: an open hand that is
/// held still by something much stiffer than an arm.

ObjectSpec block(double mass_kg, double friction, const Eigen::Vector3d& half_m);
ObjectSpec sphere(double mass_kg, double friction, double radius_m);
ArmParameters stand();

/// The drive that keeps hand and open fingers where they are.
Drive keep_still(const World& world);

/// Puts the object at `place_m` (hand's frame) as high above the palm as needed to be clear of it
/// by `gap_m`.
void put_above(World& world, const Eigen::Vector3d& place_m, double gap_m);

/// Vertical force on the object over its weight, after it was put on the palm and `seconds` have
/// passed.
double resting_force_ratio(double mass_kg, double step_s, double seconds);

/// Position error [m] after 1 s of free flight at 3 m/s with spin, against the parabola.
double free_flight_error_m(double step_s);

}  // namespace touchtrace::scene
