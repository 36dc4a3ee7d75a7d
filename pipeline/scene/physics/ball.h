#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Moves a ball through still air for `seconds`, in one step of fourth order (Runge and Kutta): its
/// weight and drag, which at 2.5 m/s is 8 % of it for a ball of table tennis. Spin goes on.
void fly(const Ball& ball, RigidState& state, double seconds);

/// 1/m: drag slows a ball by this times the square of its speed.
double drag_per_m(const Ball& ball);

/// How long ball and object can go on without a contact, `most_s` at the most. Ends a little before
/// the contact, by what an acceleration of the object that nobody foresees may do; asked again
/// there, it leads to the contact quadratically.
double free_time_s(const ObjectSpec& object, const RigidState& held, const RigidState& ball,
                   double most_s);

/// What passes between the two in one impact, at `place_m`.
struct Impact {
  Eigen::Vector3d place_m, impulse_ns;  ///< on the ball, world
  double approach_m_per_s;              ///< of the surfaces along the normal; 0 if they part
};

/// If ball and object touch, they bounce off each other: Newton's restitution along the normal;
/// across it Coulomb's friction, which at most makes the surfaces roll. Both are free for that
/// instant: hands are too soft to matter within a millisecond. The ball is put where they just
/// touch; without an impulse if they part already.
std::optional<Impact> bounce(const ObjectSpec& object, double restitution, RigidState& held,
                             RigidState& ball);

}  // namespace touchtrace::scene
