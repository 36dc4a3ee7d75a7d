#pragma once

#include <optional>
#include <string>

#include "calib/board/board_view.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// View of the board that would reduce the standard deviation of the colour camera's projection
/// most.
struct NextView {
  double column, row;        ///< centre of the board as fractions of the image's width and height
  double distance_m;         ///< of the centre of the board
  double tilt_x_rad = 0.0;   ///< about the board's x axis, from facing the camera
  double tilt_y_rad = 0.0;   ///< about its y axis
  double sigma_px, then_px;  ///< projection_sigma_quantile_px(judged_image_fraction): now, then
};

/// Compares 90 views: nine places, two distances, five tilts. A view adds the information of its
/// corners about the parameters, with their noise times the inflation by views (ViewCovariance).
/// nullopt if the whole board fits into the image in none of them, or the covariance is singular.
std::optional<NextView> find_next_view(const RgbdCalibration& calibration,
                                       const CalibrationTarget& board);

/// Pose of the board in such a view.
Eigen::Isometry3d camera_from_board(const NextView& view, const Camera& camera,
                                    const CalibrationTarget& board);

/// "in the upper left of the image, 0.45 m away, its right side turned 40 degrees away"
std::string describe(const NextView& view);

}  // namespace touchtrace
