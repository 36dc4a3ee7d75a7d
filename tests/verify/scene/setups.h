#pragma once

#include <cmath>

#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

// Setups with closed-form solutions, for tests and `touchtrace-verify scene`: an open hand held by
// an arm that is much stiffer than a real one.

ObjectSpec block(double mass_kg, double friction, const Eigen::Vector3d& half_m);
ObjectSpec sphere(double mass_kg, double friction, double radius_m);
/// Block with a huge inertia, to be placed across the fore half of the palm: it hardly rotates, so
/// that all contacts have the normal of its lower face.
ObjectSpec sled(double mass_kg, double friction);
ArmParameters rigid_arm();
/// Place of a sled on the palm.
inline const Eigen::Vector3d sled_place_m{0.0225, 0.0, 0.0};

/// Drive that holds hand and open fingers in their present position.
Drive hold_still(const World& world);

/// Places the object at `place_m` (hand's frame), with a gap of `gap_m` to the palm.
void place_above(World& world, const Eigen::Vector3d& place_m, double gap_m);

/// Simulates steps of `step_s`.
void run(World& world, const Drive& drive, double seconds, double step_s);

/// Maximum of the added values; NaN if one of them is.
struct MaxError {
  double value = 0.0;
  void add(double candidate) {
    if (!(candidate <= value) && !std::isnan(value)) value = candidate;
  }
};

/// Kinetic and potential energy of the object; height 0 at the world's origin.
double energy_j(const World& world);
bool is_finite(const World& world);

/// Vertical force on a block over its weight, `seconds` after it was placed on the palm.
double resting_force_ratio(double mass_kg, double step_s, double seconds,
                           const ContactParameters& contact = {}, double friction = 0.7);

/// Coefficient of restitution of an impact at speed v with f = g(d) (1 + c d') for any g (Hunt and
/// Crossley 1975). The work of g is the same in loading and unloading, so the rebound speed u
/// solves v / c - ln(1 + c v) / c^2 = -u / c - ln(1 - c u) / c^2.
double closed_form_restitution(double c, double v);

}  // namespace touchtrace::scene
