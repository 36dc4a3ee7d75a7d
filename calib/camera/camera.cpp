#include "calib/camera/camera.h"

#include <ceres/jet.h>

#include <Eigen/LU>
#include <limits>

namespace touchtrace {
namespace {

constexpr int max_iterations = 50;
constexpr double tolerance = 1e-14;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class L>
Eigen::Vector2d pixel_of(L lens, const std::array<double, max_intrinsics>& intrinsics,
                         const Eigen::Vector3d& point_m) {
  if (!lens.can_project(point_m)) return {nan, nan};
  return project_point<L>(intrinsics.data(), point_m);
}

/// Inverts L::distort() by Newton's method; NaN if it does not converge.
template <class L>
Eigen::Vector2d undistort(const double* coefficients, const Eigen::Vector2d& distorted) {
  using Jet = ceres::Jet<double, 2>;
  std::array<Jet, max_coefficients> k;
  for (std::size_t i = 0; i < L::coefficients.size(); ++i) k[i] = Jet(coefficients[i]);
  Eigen::Vector2d ideal = distorted;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Vector2<Jet> predicted =
        L::distort(k.data(), Vector2<Jet>(Jet(ideal.x(), 0), Jet(ideal.y(), 1)));
    Eigen::Matrix2d jacobian;
    jacobian << predicted.x().v.transpose(), predicted.y().v.transpose();
    if (!(jacobian.determinant() > 0.0)) break;
    const Eigen::Vector2d step =
        jacobian.inverse() * (Eigen::Vector2d(predicted.x().a, predicted.y().a) - distorted);
    ideal -= step;
    if (step.norm() <= tolerance * (1.0 + ideal.norm())) return ideal;
  }
  return {nan, nan};
}

}  // namespace

std::array<double, max_intrinsics> Camera::parameters() const {
  std::array<double, max_intrinsics> values{fx, fy, cx, cy};
  Eigen::Map<Eigen::Matrix<double, max_coefficients, 1>>(values.data() + 4) = distortion;
  return values;
}

void Camera::set_parameters(const std::array<double, max_intrinsics>& values) {
  fx = values[0], fy = values[1], cx = values[2], cy = values[3];
  distortion = Eigen::Map<const Eigen::Matrix<double, max_coefficients, 1>>(values.data() + 4);
}

Eigen::Vector2d Camera::project(const Eigen::Vector3d& point_m) const {
  return project_point(lens, parameters().data(), point_m);
}

void Camera::project(std::span<const Eigen::Vector3f> points_m,
                     std::span<Eigen::Vector2d> pixels) const {
  const auto intrinsics = parameters();
  with_lens(lens, [&](auto l) {
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = pixel_of(l, intrinsics, points_m[i].cast<double>());
  });
}

Eigen::Vector3d Camera::direction(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  return with_lens(lens, [&](auto l) -> Eigen::Vector3d {
    return l.direction(undistort<decltype(l)>(distortion.data(), distorted));
  });
}

Eigen::Vector3d Camera::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector3d to = direction(pixel);
  return to.z() > 0.0 ? Eigen::Vector3d(to / to.z()) : Eigen::Vector3d(nan, nan, 1.0);
}

}  // namespace touchtrace
