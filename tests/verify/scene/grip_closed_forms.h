#pragma once

namespace touchtrace::scene {

// Rows of closed_forms() about objects in the hand. Reference: the theory of small oscillations,
// unless stated otherwise.

/// Relative error of the tilt, after 1 s, of a rod that stands on its flat foot with its centre of
/// mass at `height_m` and is pushed. The foundation under the foot is a torsional spring of
/// stiffness integral k x^2 dA, gravity one of -m g height: the rod rocks or falls.
double standing_rod_error(double height_m, double step_s);

/// Relative error of the complex amplitude of a block's motion in a closed grip that is shaken at
/// 21 Hz. For steps below 0.5 ms the theory's own error of 4e-4 dominates.
double grip_response_error(double step_s);

/// Largest error of the force against m (g + a), over m g, for the same grip shaken at 2 Hz by
/// +- 3 cm, with hardening contacts. Includes the compliance of the grip.
double gripped_force_error(double step_s);

}  // namespace touchtrace::scene
