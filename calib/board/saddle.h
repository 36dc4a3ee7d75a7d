#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/board/grey_image.h"

namespace touchtrace {

/// Refines a chessboard corner to the saddle point of a quadric fitted to the grey values within
/// `radius_px`, repeated around the new position until it moves less than 1e-4 px (Lucchese and
/// Mitra, APCCAS 2002). nullopt near the image border, where the quadric has no saddle, after more
/// than 20 iterations, or more than `radius_px` from `start_px`.
std::optional<Eigen::Vector2d> refine_saddle_point(const GreyImage& image,
                                                   const Eigen::Vector2d& start_px, int radius_px);

/// Refines within `radius_px`, then within `final_radius_px` if that is smaller. The first radius
/// absorbs the error of `start_px`, the second reduces the effect of lens distortion.
std::optional<Eigen::Vector2d> refine_saddle_point(const GreyImage& image,
                                                   const Eigen::Vector2d& start_px, int radius_px,
                                                   int final_radius_px);

}  // namespace touchtrace
