#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

inline constexpr double factory_relative_sigma = 0.005;
inline constexpr double tangential_sigma = 2e-3;
inline constexpr double warp_sigma = 0.005;  ///< of the board's diagonal

/// The colour camera's principal point is near the image's centre, its lens nearly centred and the
/// board nearly flat; nothing else is known.
Prior color_prior(const BoardObservations& observations, const Lens& lens);

/// Adds what is known of the depth camera: the factory's intrinsics within 0.5 % (centre: of the
/// width) or, where unknown, those of the colour camera `parameters` within 10 %; a pose near the
/// colour camera's; a scale near 1; images that show what is no later than their stamps say by a
/// tenth of a second.
void add_depth_prior(const BoardObservations& observations, const RgbdParameters& parameters,
                     Prior& prior);

/// Deviation [m] of the board's warp.
double warp_sigma_m(const Chessboard& board);

}  // namespace touchtrace
