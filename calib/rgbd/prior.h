#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

inline constexpr double factory_relative_sigma = 0.005;
inline constexpr double tangential_sigma = 2e-3;

/// Prior of the colour camera and the board: principal point near the image centre, p1 and p2 near
/// 0, a nearly flat board. No prior on focal lengths and radial coefficients.
Prior color_prior(const BoardObservations& observations, const Lens& lens);

/// Adds the prior of the depth camera. Intrinsics: the factory's with a standard deviation of 0.5 %
/// (principal point: of the image width), or, if unknown, those of the colour camera in
/// `parameters` with 10 %. Pose near the identity (0.1 rad, 0.1 m), scale near 1 (5 %), offset near
/// 0 (50 mm), delay near 0 (0.1 s).
void add_depth_prior(const BoardObservations& observations, const RgbdParameters& parameters,
                     Prior& prior);

/// Standard deviation [m] of the warp coefficients: 0.5 % of the board's diagonal.
double warp_sigma_m(const CalibrationTarget& board);

}  // namespace touchtrace
