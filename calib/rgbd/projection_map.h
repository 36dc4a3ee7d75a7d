#pragma once

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Projection uncertainty of the colour camera at each grid pixel [rows, columns]: standard
/// deviation [px, RMS of the two directions] of the projection of a far point. As in mrcal, an
/// error that a small rotation of the camera compensates does not count; pixels determine that
/// rotation in inverse proportion to their variance. NaN where the lens cannot be inverted.
Eigen::MatrixXd projection_sigma_px(const RgbdCalibration& calibration);

/// Quantile of projection_sigma_px() over the lit part of the image; infinite if the lens cannot be
/// inverted in a larger part.
double projection_sigma_quantile_px(const RgbdCalibration& calibration, double fraction);

/// Rows of a matrix over ImageGrid; null for NaN.
nlohmann::json grid_json(const Eigen::MatrixXd& grid);

/// Index in Camera::parameters() of each estimated parameter of the colour camera.
std::vector<int> color_parameter_indices(const RgbdCalibration& calibration);

/// Derivative of the grid pixels with respect to the estimated intrinsics of the colour camera,
/// after projecting out small rotations: [2 pixels, parameters]. Rows of pixels where the lens
/// cannot be inverted are 0.
Eigen::MatrixXd rotation_free_jacobian(const RgbdCalibration& calibration);

/// Fraction of the cells of an 8x6 grid over the image that hold a corner.
double image_coverage(const Camera& camera, const std::vector<Eigen::Vector2d>& corners_px);

}  // namespace touchtrace
