#pragma once

#include "calib/board/calibration_target.h"

namespace touchtrace {

/// Returns the blobs that are the circles of a grid, in the target's order; empty if there is no
/// complete grid. From a square of neighbouring blobs, each further circle is expected where the
/// homography of a neighbouring square predicts it. Of the orders of a symmetric grid it takes any.
std::vector<Eigen::Vector2d> order_circles(const std::vector<Eigen::Vector2d>& blobs_px,
                                           const CalibrationTarget& target);

}  // namespace touchtrace
