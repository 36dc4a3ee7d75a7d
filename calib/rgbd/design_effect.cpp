#include "calib/rgbd/design_effect.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"

namespace touchtrace {
namespace {

constexpr int tiles_per_side = 4;
constexpr Eigen::Index min_samples = 3 * tiles_per_side * tiles_per_side;

struct ViewResiduals {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> values;
};

/// Values of the least-squares plane at each sample.
Eigen::VectorXd fitted_plane(const ViewResiduals& view) {
  const auto count = static_cast<Eigen::Index>(view.values.size());
  Eigen::MatrixXd design(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    design.row(i) << 1.0, view.pixels[static_cast<std::size_t>(i)].transpose();
  const Eigen::Map<const Eigen::VectorXd> values(view.values.data(), count);
  return product(design, least_squares(design, values).x);
}

/// Sum of squares with expectation `freedom` for independent samples.
struct ChiSquare {
  double squares = 0.0, freedom = 0.0;

  /// Ratio of both; 1 unless it exceeds 1 by two standard deviations.
  double excess() const {
    const double ratio = squares / std::max(freedom, 1.0);
    return ratio > 1.0 + 2.0 * std::sqrt(2.0 / std::max(freedom, 1.0)) ? ratio : 1.0;
  }
  void operator+=(const ChiSquare& other) { squares += other.squares, freedom += other.freedom; }
};

/// Squares of tile sums of `residuals`, from which a plane was subtracted: 3 degrees of freedom
/// fewer.
ChiSquare tile_sums(const ViewResiduals& view, const Eigen::VectorXd& residuals) {
  Eigen::AlignedBox2d box;
  for (const auto& pixel : view.pixels) box.extend(pixel);
  std::array<std::array<double, 2>, tiles_per_side * tiles_per_side> tiles{};
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector2d place =
        (view.pixels[i] - box.min()).cwiseQuotient(box.sizes()) * tiles_per_side;
    const int column = std::min(static_cast<int>(place.x()), tiles_per_side - 1);
    const int row = std::min(static_cast<int>(place.y()), tiles_per_side - 1);
    auto& [sum, count] = tiles[static_cast<std::size_t>(row * tiles_per_side + column)];
    sum += residuals[static_cast<Eigen::Index>(i)], count += 1.0;
  }
  ChiSquare sums{0.0, -3.0};
  for (const auto& [sum, count] : tiles)
    if (count > 0.0) sums.squares += sum * sum / count, sums.freedom += 1.0;
  return sums;
}

}  // namespace

DesignEffect design_effect(const std::vector<DepthSample>& samples,
                           const std::vector<double>& normalized) {
  std::map<std::size_t, ViewResiduals> views;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    views[samples[i].view].pixels.push_back(samples[i].pixel);
    views[samples[i].view].values.push_back(normalized[i]);
  }
  ChiSquare planes, tiles;
  for (const auto& [index, view] : views) {
    const auto count = static_cast<Eigen::Index>(view.values.size());
    if (count < min_samples) continue;
    const Eigen::VectorXd plane = fitted_plane(view);
    planes += {plane.squaredNorm(), 3.0};
    tiles += tile_sums(view, Eigen::Map<const Eigen::VectorXd>(view.values.data(), count) - plane);
  }
  return {planes.excess(), tiles.excess()};
}

}  // namespace touchtrace
