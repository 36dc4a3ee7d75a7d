#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Grey value between pixels, by bilinear interpolation; NaN outside of the image.
double interpolated_grey(const GreyImage& image, const Eigen::Vector2d& pixel);

}  // namespace touchtrace
