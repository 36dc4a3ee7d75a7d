#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Returns the centres of all circles of a symmetric or asymmetric grid, dark on a light board or
/// light on a dark one, laid out and numbered as for cv::findCirclesGrid; empty if not all are
/// visible. That function finds few tilted views of a symmetric grid, and with CALIB_CB_CLUSTERING
/// numbers some wrongly; order_circles() replaces it.
///
/// Each centre is the centroid of the circle's contrast, less the offset between the centre of an
/// ellipse and the image of the circle's centre: in a view tilted by 50 degrees this is 0.24 px for
/// circles of 30 px. The radius is estimated from the image. The offset is that of perspective;
/// lens distortion within a circle is neglected.
TargetCorners find_circle_centres(const GreyImage& image, const CalibrationTarget& target);

}  // namespace touchtrace
