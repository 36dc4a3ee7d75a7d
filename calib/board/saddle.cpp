#include "calib/board/saddle.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/matrix/decomposition.h"

namespace touchtrace {
namespace {

constexpr int max_iterations_to_saddle = 20;
constexpr double step_tolerance_px = 1e-4;

using Quadric = Eigen::Matrix<double, 6, 1>;  // coefficients of x^2, x y, y^2, x, y, 1

bool is_inside(const GreyImage& image, const Eigen::Vector2d& at, int radius_px) {
  const double margin = radius_px + 1.0;
  return at.minCoeff() >= margin && at.x() < image.width - margin && at.y() < image.height - margin;
}

/// Weighted least-squares fit. Weights fall to 0 at the rim, so that the set of pixels may change
/// without a jump.
Quadric fit_quadric(const GreyImage& image, const Eigen::Vector2d& at, int radius_px) {
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Quadric right = Quadric::Zero();
  const auto column = static_cast<int>(std::lround(at.x())),
             row = static_cast<int>(std::lround(at.y()));
  for (int v = row - radius_px; v <= row + radius_px; ++v)
    for (int u = column - radius_px; u <= column + radius_px; ++u) {
      const double x = u - at.x(), y = v - at.y(), rim = radius_px + 0.5;
      const double weight = std::max(0.0, 1.0 - (x * x + y * y) / (rim * rim));
      const Quadric terms = (Quadric() << x * x, x * y, y * y, x, y, 1.0).finished();
      normal += weight * terms * terms.transpose();
      right += weight * image.pixels[static_cast<std::size_t>(v * image.width + u)] * terms;
    }
  return solve_semidefinite(normal, right);
}

}  // namespace

std::optional<Eigen::Vector2d> refine_saddle_point(const GreyImage& image,
                                                   const Eigen::Vector2d& start_px, int radius_px) {
  Eigen::Vector2d at = start_px;
  for (int i = 0; i < max_iterations_to_saddle; ++i) {
    if (!is_inside(image, at, radius_px) || !((at - start_px).norm() <= radius_px)) return {};
    const Quadric q = fit_quadric(image, at, radius_px);
    const Eigen::Matrix2d curvature =
        (Eigen::Matrix2d() << 2 * q[0], q[1], q[1], 2 * q[2]).finished();
    if (!(curvature.determinant() < 0.0)) return {};
    const Eigen::Vector2d step = -curvature.inverse() * q.segment<2>(3);
    at += step;
    if (step.norm() < step_tolerance_px) return at;
  }
  return {};
}

std::optional<Eigen::Vector2d> refine_saddle_point(const GreyImage& image,
                                                   const Eigen::Vector2d& start_px, int radius_px,
                                                   int final_radius_px) {
  const auto corner = refine_saddle_point(image, start_px, radius_px);
  return corner && radius_px > final_radius_px
             ? refine_saddle_point(image, *corner, final_radius_px)
             : corner;
}

}  // namespace touchtrace
