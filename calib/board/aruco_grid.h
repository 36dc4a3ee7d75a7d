#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Returns the corners of the visible markers of a grid (cv::aruco::GridBoard): of one dictionary,
/// numbered along the rows from 0 at the upper left. Both are empty if they do not determine a
/// pose.
///
/// Frame: origin at the upper left corner of marker 0, x to the right, y down.
///
/// Throws usage_error for an unknown dictionary, more markers than it has, or markers without space
/// between them.
TargetCorners find_aruco_grid_corners(const GreyImage& image, const CalibrationTarget& grid);

}  // namespace touchtrace
