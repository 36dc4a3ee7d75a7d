#pragma once

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {

/// [flights] Cramer-Rao bounds of the landing times' standard deviations [s] for a motion with the
/// given noise and all other event times known.
std::vector<double> landing_sigma_bounds_s(const SyntheticMotion& motion, const Track& track,
                                           const MotionNoise& noise, const SmoothOptions& options);

/// Lower bound of the velocity RMS at camera frames [m/s]; `known_rms`: the RMS if impact times
/// were known. A frame near an impact, whose time is normally distributed with standard deviation
/// s, may be before or after it: the best estimate leaves J^2 P (1 - P) of the velocity jump J,
/// which integrates to J^2 s / sqrt(pi) over the frame's time.
double velocity_rms_bound(double known_rms, const SyntheticMotion& motion,
                          const std::vector<double>& sigmas_s);

}  // namespace touchtrace
