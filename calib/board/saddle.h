#pragma once

#include <optional>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// Where four squares meet: the saddle point of the quadric that fits the grey values within
/// `radius_px` best, fitted anew around itself until it stays (Lucchese and Mitra, APCCAS 2002).
/// Nothing near the image's border, where there is no saddle, or more than `radius_px` from
/// `start_px`.
std::optional<Eigen::Vector2d> saddle_point(const GreyImage& image, const Eigen::Vector2d& start_px,
                                            int radius_px);

}  // namespace touchtrace
