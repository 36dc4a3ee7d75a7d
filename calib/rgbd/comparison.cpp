#include "calib/rgbd/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/matrix/decomposition.h"
#include "calib/rgbd/projection_map.h"
#include "calib/rgbd/rotation.h"
#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd;

constexpr int num_rotation_steps = 5;
constexpr double derivative_step_rad = 1e-6;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct GridPoint {
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;  ///< of calibration a
  double sigma_px;
};

Eigen::Vector2d shift(const Camera& b, const GridPoint& point, const Eigen::Vector3d& rotation) {
  return b.project(rotation_matrix(rotation) * point.ray) - point.pixel;
}

/// Derivative of shift() by the rotation.
Eigen::Matrix<double, 2, 3> shift_jacobian(const Camera& b, const GridPoint& point,
                                           const Eigen::Vector3d& rotation) {
  Eigen::Matrix<double, 2, 3> jacobian;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = derivative_step_rad * Eigen::Vector3d::Unit(i);
    jacobian.col(i) = (shift(b, point, rotation + step) - shift(b, point, rotation - step)) /
                      (2.0 * derivative_step_rad);
  }
  return jacobian;
}

/// Rotation with the least weighted squares of the shifts.
Eigen::Vector3d fit_rotation(const Camera& b, const std::vector<GridPoint>& points) {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  for (int i = 0; i < num_rotation_steps; ++i) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const GridPoint& point : points) {
      const Eigen::Vector2d error = shift(b, point, rotation);
      const auto jacobian = shift_jacobian(b, point, rotation);
      if (!error.allFinite() || !jacobian.allFinite()) continue;
      const double weight = 1.0 / (point.sigma_px * point.sigma_px);
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * error;
    }
    rotation += solve_semidefinite(normal, right);
  }
  return rotation;
}

std::vector<double> finite(const MatrixXd& values) {
  std::vector<double> result;
  for (double value : values.reshaped())
    if (std::isfinite(value)) result.push_back(value);
  return result;
}

/// Standard deviation of the length of a shift in two directions.
MatrixXd shift_sigma_px(const RgbdCalibration& a, const RgbdCalibration& b) {
  return (2.0 * (projection_sigma_px(a).cwiseAbs2() + projection_sigma_px(b).cwiseAbs2()))
      .cwiseSqrt();
}

}  // namespace

double CalibrationDifference::median_px() const { return median(finite(shift_px)); }

double CalibrationDifference::worst_px() const { return std::ranges::max(finite(shift_px)); }

double CalibrationDifference::rms_sigmas() const {
  const auto squares = finite(shift_px.cwiseQuotient(sigma_px).cwiseAbs2());
  double sum = 0.0;
  for (double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

double CalibrationDifference::worst_sigmas() const {
  return std::ranges::max(finite(shift_px.cwiseQuotient(sigma_px)));
}

CalibrationDifference compare(const RgbdCalibration& a, const RgbdCalibration& b) {
  if (a.color.width != b.color.width || a.color.height != b.color.height)
    throw data_error(fmt::format("the calibrations are of {}x{} and of {}x{} pixels", a.color.width,
                                 a.color.height, b.color.width, b.color.height),
                     "compare calibrations of one camera and one image size");
  CalibrationDifference result{MatrixXd::Constant(ImageGrid::rows, ImageGrid::columns, nan),
                               shift_sigma_px(a, b), a.color.fx};
  std::vector<GridPoint> points;
  std::vector<std::pair<int, int>> cells;
  for (int row = 0; row < ImageGrid::rows; ++row)
    for (int column = 0; column < ImageGrid::columns; ++column) {
      const Eigen::Vector2d pixel = ImageGrid::pixel(a.color.width, a.color.height, column, row);
      const GridPoint point{pixel, a.color.unproject(pixel), result.sigma_px(row, column)};
      if (!point.ray.allFinite() || !(point.sigma_px > 0.0)) continue;
      points.push_back(point), cells.emplace_back(row, column);
    }
  const Eigen::Vector3d rotation = fit_rotation(b.color, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    result.shift_px(cells[i].first, cells[i].second) = shift(b.color, points[i], rotation).norm();
  if (finite(result.shift_px).empty())
    throw data_error(
        "no pixel of the two calibrations can be compared",
        "give calibration.json files of `touchtrace calibrate`, which hold a covariance");
  return result;
}

nlohmann::json difference_json(const CalibrationDifference& difference) {
  return {{"agree", difference.agrees()},
          {"rms_sigmas", difference.rms_sigmas()},
          {"worst_sigmas", difference.worst_sigmas()},
          {"median_px", difference.median_px()},
          {"worst_px", difference.worst_px()},
          {"shift_px", grid_json(difference.shift_px)},
          {"sigma_px", grid_json(difference.sigma_px)}};
}

}  // namespace touchtrace
