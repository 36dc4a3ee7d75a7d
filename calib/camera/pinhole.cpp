#include "calib/camera/pinhole.h"

#include <Eigen/LU>
#include <array>
#include <limits>

namespace touchtrace {
namespace {

constexpr int max_iterations = 50;
constexpr double tolerance = 1e-14;

/// Derivative of the distorted (x", y") by the ideal (x', y'); symmetric for this model.
Eigen::Matrix2d distortion_jacobian(const Eigen::Matrix<double, 5, 1>& k, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double slope = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);
  const double mixed = 2.0 * (x * y * slope + k[2] * x + k[3] * y);
  Eigen::Matrix2d jacobian;
  jacobian << radial + 2.0 * x * x * slope + 2.0 * k[2] * y + 6.0 * k[3] * x, mixed,  //
      mixed, radial + 2.0 * y * y * slope + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return jacobian;
}

}  // namespace

std::array<double, 9> PinholeCamera::parameters() const {
  std::array<double, 9> values{fx, fy, cx, cy};
  Eigen::Map<Eigen::Matrix<double, 5, 1>>(values.data() + 4) = distortion;
  return values;
}

void PinholeCamera::set_parameters(const std::array<double, 9>& values) {
  fx = values[0], fy = values[1], cx = values[2], cy = values[3];
  distortion = Eigen::Map<const Eigen::Matrix<double, 5, 1>>(values.data() + 4);
}

Eigen::Vector2d PinholeCamera::project(const Eigen::Vector3d& point_m) const {
  return project_point(parameters().data(), point_m);
}

Eigen::Vector3d PinholeCamera::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  const std::array<double, 9> normalized{1.0,           1.0,           0.0,
                                         0.0,           distortion[0], distortion[1],
                                         distortion[2], distortion[3], distortion[4]};
  Eigen::Vector2d ideal = distorted;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::Matrix2d jacobian = distortion_jacobian(distortion, ideal.x(), ideal.y());
    if (!(jacobian.determinant() > 0.0)) break;
    const Eigen::Vector2d error =
        project_point(normalized.data(), Eigen::Vector3d(ideal.x(), ideal.y(), 1.0)) - distorted;
    const Eigen::Vector2d step = jacobian.inverse() * error;
    ideal -= step;
    if (step.norm() <= tolerance * (1.0 + ideal.norm())) return {ideal.x(), ideal.y(), 1.0};
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {nan, nan, 1.0};
}

}  // namespace touchtrace
