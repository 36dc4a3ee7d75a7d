#include "calib/rgbd/projection_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "calib/camera/projection_jacobian.h"
#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {
namespace {

using Eigen::Index, Eigen::MatrixXd;

constexpr int num_weighting_rounds = 3;

/// Derivatives [2 pixels, ..] of the grid pixels; 0 where the lens cannot be inverted.
struct GridJacobian {
  MatrixXd by_intrinsics, by_rotation;
};

GridJacobian grid_jacobian(const RgbdCalibration& c) {
  const auto indices = color_parameter_indices(c);
  constexpr Index pixels = ImageGrid::columns * ImageGrid::rows;
  GridJacobian grid{MatrixXd::Zero(2 * pixels, Index(indices.size())),
                    MatrixXd::Zero(2 * pixels, 3)};
  for (Index i = 0; i < pixels; ++i) {
    const Eigen::Vector3d direction = c.color.direction(ImageGrid::pixel(
        c.color.width, c.color.height, int(i % ImageGrid::columns), int(i / ImageGrid::columns)));
    if (!direction.allFinite()) continue;
    const ProjectionJacobian jacobian = projection_jacobian(c.color, direction);
    for (std::size_t k = 0; k < indices.size(); ++k)
      grid.by_intrinsics.block<2, 1>(2 * i, Index(k)) = jacobian.by_intrinsics.col(indices[k]);
    grid.by_rotation.middleRows<2>(2 * i) = -jacobian.by_point * cross_matrix(direction);
  }
  return grid;
}

/// Variance [px^2] of each row's pixel; 0 where the lens cannot be inverted.
Eigen::VectorXd row_variance(const MatrixXd& jacobian, const MatrixXd& covariance) {
  return product(jacobian, covariance).cwiseProduct(jacobian).rowwise().sum();
}

}  // namespace

MatrixXd rotation_free_jacobian(const RgbdCalibration& c) {
  const GridJacobian grid = grid_jacobian(c);
  const Index size = grid.by_intrinsics.cols();
  const MatrixXd covariance = c.covariance.topLeftCorner(size, size);
  MatrixXd result = grid.by_intrinsics;
  for (int round = 0; round < num_weighting_rounds; ++round) {
    const Eigen::VectorXd variance = row_variance(result, covariance);
    const Eigen::VectorXd weight =
        (variance.array() > 0.0).select(variance.cwiseSqrt().cwiseInverse(), 0.0);
    const LeastSquares fit = least_squares(weight.asDiagonal() * grid.by_rotation,
                                           weight.asDiagonal() * grid.by_intrinsics);
    result = grid.by_intrinsics - product(grid.by_rotation, fit.x);
  }
  return result;
}

std::vector<int> color_parameter_indices(const RgbdCalibration& c) {
  const auto names = intrinsic_names(c.color.lens);
  std::vector<int> indices;
  for (const std::string& parameter : c.parameters)
    for (std::size_t i = 0; i < names.size(); ++i)
      if (parameter == "color." + names[i]) indices.push_back(static_cast<int>(i));
  return indices;
}

MatrixXd projection_sigma_px(const RgbdCalibration& c) {
  const MatrixXd jacobian = rotation_free_jacobian(c);
  const MatrixXd covariance = c.covariance.topLeftCorner(jacobian.cols(), jacobian.cols());
  const Eigen::VectorXd variance = row_variance(jacobian, covariance);
  MatrixXd sigma(ImageGrid::rows, ImageGrid::columns);
  for (Index i = 0; i < sigma.size(); ++i)
    sigma(i / ImageGrid::columns, i % ImageGrid::columns) =
        jacobian.middleRows<2>(2 * i).isZero(0.0)
            ? std::numeric_limits<double>::quiet_NaN()
            : std::sqrt(0.5 * variance.segment<2>(2 * i).sum());
  return sigma;
}

double projection_sigma_quantile_px(const RgbdCalibration& c, double fraction) {
  const MatrixXd map = projection_sigma_px(c);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> sigmas;
  for (Index i = 0; i < map.size(); ++i)
    if (c.lit.reshaped()[i]) sigmas.push_back(std::isfinite(map(i)) ? map(i) : infinity);
  if (sigmas.empty()) return infinity;
  const auto at = sigmas.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(sigmas.size() - 1));
  std::ranges::nth_element(sigmas, at);
  return *at;
}

nlohmann::json grid_json(const MatrixXd& grid) {
  nlohmann::json rows = nlohmann::json::array();
  for (Index i = 0; i < grid.rows(); ++i) {
    nlohmann::json row = nlohmann::json::array();
    for (double value : grid.row(i))
      row.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
    rows.push_back(std::move(row));
  }
  return rows;
}

double image_coverage(const Camera& camera, const std::vector<Eigen::Vector2d>& corners_px) {
  constexpr int across = 8, down = 6;
  std::set<std::pair<int, int>> covered;
  for (const auto& corner : corners_px) {
    const int column = static_cast<int>((corner.x() + 0.5) / camera.width * across);
    const int row = static_cast<int>((corner.y() + 0.5) / camera.height * down);
    covered.emplace(std::clamp(column, 0, across - 1), std::clamp(row, 0, down - 1));
  }
  return static_cast<double>(covered.size()) / (across * down);
}

}  // namespace touchtrace
