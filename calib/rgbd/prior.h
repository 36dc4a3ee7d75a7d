#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

inline constexpr double factory_relative_sigma = 0.005;
inline constexpr double tangential_sigma = 2e-3;

/// The colour camera's principal point is near the image's centre and its lens nearly centred;
/// nothing else is known of it.
Prior color_prior(const BoardObservations& observations);

/// Adds what is known of the depth camera: the factory's intrinsics within 0.5 % (centre: of the
/// width) or, where unknown, those of the colour camera `parameters` within 10 %; a pose near the
/// colour camera's; a scale near 1.
void add_depth_prior(const BoardObservations& observations, const RgbdParameters& parameters,
                     Prior& prior);

}  // namespace touchtrace
