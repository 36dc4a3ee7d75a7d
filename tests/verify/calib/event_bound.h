#pragma once

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {

/// The least deviation with which any unbiased estimate finds the time of each flight's landing
/// [flights, s], by Cramer and Rao: all else of the motion is as `noise` says, and every other
/// event's time is known.
std::vector<double> least_landing_deviations_s(const SyntheticMotion& motion, const Track& track,
                                               const MotionNoise<double>& noise,
                                               const SmoothOptions& options);

/// The least RMS of velocity at a camera's frames [m/s], `known_rms` if times of impacts were
/// known. A frame next to an impact, whose time is normal with deviation s, may lie before or after
/// it, and the best guess leaves J^2 P (1 - P) of the jump J: J^2 s / sqrt(pi) over all places of a
/// frame.
double least_velocity_rms(double known_rms, const SyntheticMotion& motion,
                          const std::vector<double>& deviations_s);

}  // namespace touchtrace
