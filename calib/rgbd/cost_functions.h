#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <cmath>

#include "calib/camera/pinhole.h"

namespace touchtrace {

/// Pixels, projected minus measured, in units of sigma.
struct CornerError {
  Eigen::Vector3d corner_m;
  Eigen::Vector2d measured_px;
  double sigma_px;

  template <class T>
  bool operator()(const T* color, const T* camera_from_board, T* residual) const {
    const Eigen::Matrix<T, 3, 1> corner = corner_m.cast<T>();
    Eigen::Matrix<T, 3, 1> p;
    ceres::AngleAxisRotatePoint(camera_from_board, corner.data(), p.data());
    p += Eigen::Map<const Eigen::Matrix<T, 3, 1>>(camera_from_board + 3);
    if (!(p.z() > T(0))) return false;
    Eigen::Map<Eigen::Matrix<T, 2, 1>> error(residual);
    error = (project_point(color, p) - measured_px.cast<T>()) / T(sigma_px);
    return true;
  }
};

/// Depth of the board's plane along the ray of depth pixel `pixel`; `depth`: fx fy cx cy.
template <class T>
T plane_depth(const Eigen::Vector2d& pixel, const T* camera_from_board, const T* depth_from_color,
              const T* depth) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const Vector board_normal(T(0), T(0), T(1));
  Vector color_normal, normal, origin;
  ceres::AngleAxisRotatePoint(camera_from_board, board_normal.data(), color_normal.data());
  ceres::AngleAxisRotatePoint(depth_from_color, color_normal.data(), normal.data());
  ceres::AngleAxisRotatePoint(depth_from_color, camera_from_board + 3, origin.data());
  origin += Eigen::Map<const Vector>(depth_from_color + 3);
  const Vector ray((T(pixel.x()) - depth[2]) / depth[0], (T(pixel.y()) - depth[3]) / depth[1],
                   T(1));
  return normal.dot(origin) / normal.dot(ray);
}

/// Measured depth, model minus measurement, in units of sigma; `correction`: scale, offset.
struct DepthError {
  Eigen::Vector2d pixel;
  double measured_m, sigma_m;

  template <class T>
  bool operator()(const T* camera_from_board, const T* depth_from_color, const T* depth,
                  const T* correction, T* residual) const {
    const T plane = plane_depth(pixel, camera_from_board, depth_from_color, depth);
    residual[0] = ((plane - correction[1]) / correction[0] - T(measured_m)) / T(sigma_m);
    return true;
  }
};

/// A parameter block of N against its mean, in units of sigma; an infinite sigma weighs nothing.
template <int N>
struct PriorError {
  std::array<double, N> mean, sigma;

  template <class T>
  bool operator()(const T* values, T* residual) const {
    for (int i = 0; i < N; ++i) residual[i] = (values[i] - T(mean[i])) / T(sigma[i]);
    return true;
  }
};

}  // namespace touchtrace
