#pragma once

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Pixels over the image, row by row.
struct ImageGrid {
  static constexpr int columns = 9, rows = 7;

  static Eigen::Vector2d pixel(const Camera& camera, int column, int row) {
    return {(camera.width - 1.0) * column / (columns - 1),
            (camera.height - 1.0) * row / (rows - 1)};
  }
};

/// Deviation [px, RMS of the two directions] of where a far point is seen, at each pixel of the
/// grid: how far the calibration may be off there. What a small turn of the camera would make up
/// for over the whole image does not count, as in mrcal's projection uncertainty: no one can see
/// it. NaN where the lens cannot be inverted.
Eigen::MatrixXd projection_sigma_px(const RgbdCalibration& calibration);

/// Derivative of the grid's pixels by the free intrinsics of the colour camera, without what a turn
/// makes up for: [2 pixels, parameters]. Rows of pixels that the lens does not see are 0.
Eigen::MatrixXd free_of_turns(const RgbdCalibration& calibration);

/// Share of the image's cells, 8 by 6, that hold a corner.
double coverage(const Camera& camera, const std::vector<Eigen::Vector2d>& corners_px);

}  // namespace touchtrace
