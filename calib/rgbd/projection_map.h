#pragma once

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Regular grid of pixels that spans the image.
struct ImageGrid {
  static constexpr int columns = 9, rows = 7;

  static Eigen::Vector2d pixel(const Camera& camera, int column, int row) {
    return {(camera.width - 1.0) * column / (columns - 1),
            (camera.height - 1.0) * row / (rows - 1)};
  }
};

/// Projection uncertainty of the colour camera at each grid pixel [rows, columns]: standard
/// deviation [px, RMS of the two directions] of the projection of a far point. As in mrcal, an
/// error that a small rotation of the camera compensates over the whole image does not count. NaN
/// where the lens cannot be inverted.
Eigen::MatrixXd projection_sigma_px(const RgbdCalibration& calibration);

/// Derivative of the grid pixels with respect to the estimated intrinsics of the colour camera,
/// after projecting out small rotations: [2 pixels, parameters]. Rows of pixels that cannot be
/// unprojected are 0.
Eigen::MatrixXd rotation_free_jacobian(const RgbdCalibration& calibration);

/// Fraction of the cells of an 8x6 grid over the image that hold a corner.
double image_coverage(const Camera& camera, const std::vector<Eigen::Vector2d>& corners_px);

}  // namespace touchtrace
