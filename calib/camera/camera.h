#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "calib/camera/lens.h"

namespace touchtrace {

/// A camera and its lens. Pixel (0, 0) is the centre of the upper left pixel. Camera frame: x
/// right, y down, z forward, metres.
struct Camera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Lens lens = Undistorted{};
  /// In the order of coefficient_names(lens); zeros after them.
  Eigen::Matrix<double, max_coefficients, 1> distortion =
      Eigen::Matrix<double, max_coefficients, 1>::Zero();

  /// Camera-frame point [m] to pixel; NaN for a point that the lens does not see.
  Eigen::Vector2d project(const Eigen::Vector3d& point_m) const;
  /// As many points as `pixels` has room for.
  void project(std::span<const Eigen::Vector3f> points_m, std::span<Eigen::Vector2d> pixels) const;
  /// Pixel to the ray (x', y', 1); the distortion is inverted by Newton iterations. NaN where the
  /// model cannot be inverted, which happens far outside the image under strong distortion, and
  /// where a fisheye looks 90 degrees and more to the side.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const;

  /// fx fy cx cy, then `distortion`, as project_point takes them.
  std::array<double, max_intrinsics> parameters() const;
  void set_parameters(const std::array<double, max_intrinsics>& values);
};

}  // namespace touchtrace
