#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Lower bound of the estimated corner noise: weights of noise-free data stay finite.
inline constexpr double min_corner_sigma_px = 1e-6;

/// Twice the number of corners in the used views.
double num_corner_coordinates(const BoardObservations& observations, const std::vector<bool>& used);

/// Noise of one corner coordinate [px], from the residuals of the used views and the degrees of
/// freedom without per-corner deformation.
double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters);

/// Sum of squared residuals [px^2] of the corners in the used views.
double sum_of_squares(const BoardObservations& observations, const std::vector<bool>& used,
                      const RgbdParameters& parameters);

/// RMS length of the residuals [px], as OpenCV reports it. 0 if there are none.
double rms(const std::vector<Eigen::Vector2d>& residuals);

/// rms() over all corners of the used views.
double rms_of_used_views(const BoardObservations& observations, const std::vector<bool>& used,
                         const RgbdParameters& parameters);

}  // namespace touchtrace
