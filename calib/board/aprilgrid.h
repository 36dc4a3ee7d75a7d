#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Returns the visible corners of kalibr's AprilGrid: tags 36h11, upright, numbered along the rows
/// from the lower left one, with black squares between their corners. Both are empty if they do
/// not determine a pose. Tags may have a border of two bits, as kalibr prints them, or of one.
///
/// The frame of the target has its origin at the upper left corner, x to the right, y down;
/// kalibr's is at the lower left, y up.
///
/// From the tags that OpenCV decodes, other corners are predicted by LocalHomography. A corner is
/// used if it is a saddle point with more than half the median contrast.
///
/// Throws usage_error for more tags than 36h11 has, or tags without space between them.
TargetCorners find_aprilgrid_corners(const GreyImage& image, const CalibrationTarget& target);

}  // namespace touchtrace
