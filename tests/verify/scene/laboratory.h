#pragma once

#include <cmath>

#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

/// Set-ups with closed forms, for tests and for `touchtrace-verify scene`: an open hand that is
/// held still by something much stiffer than an arm.

ObjectSpec block(double mass_kg, double friction, const Eigen::Vector3d& half_m);
ObjectSpec sphere(double mass_kg, double friction, double radius_m);
/// A block that hardly turns, to lie across the fore half of the palm: every contact has the normal
/// of its lower face.
ObjectSpec sled(double mass_kg, double friction);
ArmParameters stand();
/// Where a sled is put on the palm.
inline const Eigen::Vector3d sled_place_m{0.0225, 0.0, 0.0};

/// The drive that keeps hand and open fingers where they are.
Drive keep_still(const World& world);

/// Puts the object at `place_m` (hand's frame) as high above the palm as needed to be clear of it
/// by `gap_m`.
void put_above(World& world, const Eigen::Vector3d& place_m, double gap_m);

void run(World& world, const Drive& drive, double seconds, double step_s);

/// Largest of values; NaN as soon as one of them is.
struct Worst {
  double value = 0.0;
  void add(double candidate) {
    if (!(candidate <= value) && !std::isnan(value)) value = candidate;
  }
};

/// Of the object, with height 0 at the world's origin.
double energy_j(const World& world);
bool finite(const World& world);

/// Vertical force on the object over its weight, after it was put on the palm and `seconds` have
/// passed.
double resting_force_ratio(double mass_kg, double step_s, double seconds,
                           const ContactParameters& contact = {}, double friction = 0.7);

/// With f = g(d) (1 + c d') for any g, the work of g is the same on both ways: the rebound u of an
/// impact at v solves v / c - ln(1 + c v) / c^2 = -u / c - ln(1 - c u) / c^2 (Hunt and Crossley
/// 1975).
double closed_form_restitution(double c, double v);

}  // namespace touchtrace::scene
