#include "calib/rgbd/design_effect.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace touchtrace {
namespace {

constexpr int tiles_per_side = 4;
constexpr Eigen::Index fewest_samples = 3 * tiles_per_side * tiles_per_side;

struct ViewResiduals {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> values;
};

Eigen::VectorXd without_plane(const ViewResiduals& view) {
  const auto count = static_cast<Eigen::Index>(view.values.size());
  Eigen::MatrixXd design(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    design.row(i) << 1.0, view.pixels[static_cast<std::size_t>(i)].transpose();
  const Eigen::Map<const Eigen::VectorXd> values(view.values.data(), count);
  return values - design * design.colPivHouseholderQr().solve(values);
}

struct TileSums {
  double squares = 0.0;  ///< of the tiles' sums over the square root of their sizes
  double freedom = 0.0;  ///< tiles less the plane's three parameters
};

TileSums tile_sums(const ViewResiduals& view) {
  const Eigen::VectorXd residuals = without_plane(view);
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
  TileSums sums{0.0, -3.0};
  for (const auto& [sum, count] : tiles)
    if (count > 0.0) sums.squares += sum * sum / count, sums.freedom += 1.0;
  return sums;
}

}  // namespace

double design_effect(const std::vector<DepthSample>& samples,
                     const std::vector<double>& normalized) {
  std::map<std::size_t, ViewResiduals> views;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    views[samples[i].view].pixels.push_back(samples[i].pixel);
    views[samples[i].view].values.push_back(normalized[i]);
  }
  TileSums total;
  for (const auto& [index, view] : views) {
    if (static_cast<Eigen::Index>(view.values.size()) < fewest_samples) continue;
    const TileSums sums = tile_sums(view);
    total.squares += sums.squares, total.freedom += sums.freedom;
  }
  if (total.freedom < 1.0) return 1.0;
  const double effect = total.squares / total.freedom;
  return effect > 1.0 + 2.0 * std::sqrt(2.0 / total.freedom) ? effect : 1.0;
}

}  // namespace touchtrace
