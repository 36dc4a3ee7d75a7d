#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "calib/camera/lens.h"

namespace touchtrace {

/// Intrinsics and lens of one camera.
///
/// Pixel (u, v) = (column, row); (0, 0) is the centre of the upper left pixel, so that the image
/// covers [-0.5, width - 0.5] x [-0.5, height - 0.5]. Camera frame: x right, y down, z forward,
/// metres.
struct Camera {
  int width = 0, height = 0;              ///< [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< focal lengths and principal point [px]
  Lens lens = Undistorted{};
  /// In the order of coefficient_names(lens), then zeros.
  Eigen::Matrix<double, max_coefficients, 1> distortion =
      Eigen::Matrix<double, max_coefficients, 1>::Zero();

  /// Projects a point of the camera frame [m] to a pixel. NaN where the lens cannot project.
  Eigen::Vector2d project(const Eigen::Vector3d& point_m) const;
  /// Projects the first pixels.size() points.
  void project(std::span<const Eigen::Vector3f> points_m, std::span<Eigen::Vector2d> pixels) const;
  /// Returns the direction of a pixel, a vector of any length, by Newton iterations on the
  /// distortion. NaN where the distortion cannot be inverted, which happens far outside of the
  /// image if it is strong.
  Eigen::Vector3d direction(const Eigen::Vector2d& pixel) const;
  /// Returns the ray (X/Z, Y/Z, 1) of a pixel. NaN where direction() is, and at 90 degrees or more
  /// to the optical axis.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const;

  /// fx fy cx cy, then `distortion`: the layout of project_point().
  std::array<double, max_intrinsics> parameters() const;
  void set_parameters(const std::array<double, max_intrinsics>& values);
};

}  // namespace touchtrace
