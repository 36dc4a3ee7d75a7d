#pragma once

namespace touchtrace::scene {

/// Rows of the table of closed forms about objects in the hand: error at a step, against the theory
/// of small motions unless said otherwise.

/// A rod that stands on its flat foot, its centre of mass `height_m` up, is pushed. The foundation
/// under the foot is a spring of integral k x^2 dA against turning; gravity takes m g height of
/// that: the rod rocks or falls. Relative error of its tilt after 1 s.
double standing_rod_error(double height_m, double step_s);

/// A block in a closed grip is shaken at 21 Hz: error of its motion against the hand, in
/// amplitude and phase, over that motion. Below steps of 0.5 ms the theory's own error shows, which
/// is 4e-4.
double grip_response_error(double step_s);

/// The same at 2 Hz and 3 cm to either side, with the hand's own springs: force against m (g + a)
/// through the cycle, over m g. It differs by what the grip gives way.
double gripped_force_error(double step_s);

}  // namespace touchtrace::scene
