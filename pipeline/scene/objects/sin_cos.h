#pragma once

#include <bit>

#include "pipeline/scene/objects/lanes.h"

namespace touchtrace::scene {

struct SinCos {
  Lanes sine, cosine;
};

/// Sine and cosine of angles up to 1e5 rad, with an absolute error of 2e-16. Subtracts the nearest
/// multiple of a quarter turn and evaluates the polynomials of fdlibm (k_sin.c, k_cos.c).
inline SinCos sin_cos(Lanes angle_rad) {
  constexpr double quarters_per_rad = 0.63661977236758134308, to_whole = 0x1.8p52;
  // pi / 2 in parts of 33 bits, so that their multiples are exact (Cody and Waite).
  constexpr double quarter[]{1.57079632673412561417e+00, 6.07710050630396597660e-11,
                             2.02226624879595063154e-21};
  const Lanes shifted = angle_rad * quarters_per_rad + to_whole, count = shifted - to_whole;
  const auto quadrant = std::bit_cast<LaneMask>(shifted);
  const Lanes x = ((angle_rad - count * quarter[0]) - count * quarter[1]) - count * quarter[2];
  const Lanes z = x * x;
  Lanes sine = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10;
  for (const double term : {2.75573137070700676789e-06, -1.98412698298579493134e-04,
                            8.33333333332248946124e-03, -1.66666666666666324348e-01})
    sine = term + z * sine;
  sine = x + x * z * sine;
  Lanes cosine = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11;
  for (const double term : {-2.75573143513906633035e-07, 2.48015872894767294178e-05,
                            -1.38888888888741095749e-03, 4.16666666666666019037e-02})
    cosine = term + z * cosine;
  cosine = 1 - (0.5 * z - z * z * cosine);
  const LaneMask is_odd = (quadrant & 1) != 0;
  const Lanes s = is_odd ? cosine : sine, c = is_odd ? sine : cosine;
  return {(quadrant & 2) != 0 ? -s : s, ((quadrant + 1) & 2) != 0 ? -c : c};
}

}  // namespace touchtrace::scene
