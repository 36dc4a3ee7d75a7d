#pragma once

#include <Eigen/Core>
#include <array>

namespace touchtrace {

/// A pinhole camera with radial-tangential distortion, as OpenCV defines it.
///
/// Pixel (0, 0) is the centre of the upper left pixel. Camera frame: x right, y down, z forward,
/// metres.
///     x' = X/Z, y' = Y/Z, r2 = x'^2 + y'^2, d = 1 + k1 r2 + k2 r2^2 + k3 r2^3
///     x" = x' d + 2 p1 x' y' + p2 (r2 + 2 x'^2),  u = fx x" + cx
///     y" = y' d + p1 (r2 + 2 y'^2) + 2 p2 x' y',  v = fy y" + cy
struct PinholeCamera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Eigen::Matrix<double, 5, 1> distortion = Eigen::Matrix<double, 5, 1>::Zero();  ///< k1 k2 p1 p2 k3

  /// Camera-frame point [m] to pixel. The point must lie before the camera (z > 0).
  Eigen::Vector2d project(const Eigen::Vector3d& point_m) const;
  /// Pixel to the ray (x', y', 1); the distortion is inverted by Newton iterations. NaN where the
  /// model cannot be inverted, which happens far outside the image under strong distortion.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const;

  /// fx fy cx cy k1 k2 p1 p2 k3, as project_point takes them.
  std::array<double, 9> parameters() const;
  void set_parameters(const std::array<double, 9>& values);
};

/// The projection above for any scalar, so that Ceres differentiates it. `intrinsics`: fx fy cx cy
/// k1 k2 p1 p2 k3.
template <class T>
Eigen::Matrix<T, 2, 1> project_point(const T* intrinsics, const Eigen::Matrix<T, 3, 1>& p) {
  const T x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const T* k = intrinsics + 4;
  const T radial = T(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const T dx = T(2) * k[2] * x * y + k[3] * (r2 + T(2) * x * x);
  const T dy = k[2] * (r2 + T(2) * y * y) + T(2) * k[3] * x * y;
  return {intrinsics[0] * (x * radial + dx) + intrinsics[2],
          intrinsics[1] * (y * radial + dy) + intrinsics[3]};
}

}  // namespace touchtrace
