#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Moves a ball through still air with gravity and quadratic drag (8 % of the weight at 2.5 m/s for
/// a table tennis ball): one step of the classical Runge-Kutta method. The spin stays constant.
void fly(const Ball& ball, RigidState& state, double seconds);

/// Drag deceleration over squared speed [1/m].
double drag_per_m(const Ball& ball);

/// Returns a time, `max_s` at most, in which ball and object cannot touch if the object's
/// acceleration stays below 300 m/s^2. Repeated at the new time, it converges quadratically to the
/// contact.
double contact_free_time_s(const ObjectSpec& object, const RigidState& held, const RigidState& ball,
                           double max_s);

/// One impact of ball and object.
struct Impact {
  Eigen::Vector3d point_m, impulse_ns;  ///< impulse on the ball; world frame
  double approach_m_per_s;              ///< relative speed along the normal; 0 if they separate
};

/// Resolves an impact if ball and object touch: Newton's restitution along the normal, Coulomb
/// friction across it, which at most makes the ball roll. Both bodies are free in the impact: hands
/// are too soft to matter within a millisecond. Moves the ball to where it just touches. Zero
/// impulse if the bodies already separate.
std::optional<Impact> bounce(const ObjectSpec& object, double restitution, RigidState& held,
                             RigidState& ball);

}  // namespace touchtrace::scene
