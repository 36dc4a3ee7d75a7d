#include "pipeline/label/observe/background.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

/// Applies `select` to the measurements of every pixel. 0 where there are fewer than `min_count`.
template <class Select>
std::vector<std::uint16_t> for_each_pixel(const DepthImages& depths, std::size_t min_count,
                                          Select&& select) {
  std::vector<std::uint16_t> result(depths.empty() ? 0 : depths.front().size()), measured;
  for (std::size_t pixel = 0; pixel < result.size(); ++pixel) {
    measured.clear();
    for (const auto& depth : depths)
      if (depth[pixel] > 0) measured.push_back(depth[pixel]);
    if (measured.size() >= min_count) result[pixel] = select(measured);
  }
  return result;
}

}  // namespace

std::vector<std::uint16_t> median_depth(const DepthImages& depths) {
  return for_each_pixel(depths, 1, [](std::vector<std::uint16_t>& measured) {
    const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
    std::ranges::nth_element(measured, middle);
    return *middle;
  });
}

std::vector<std::uint16_t> farthest_depth(const DepthImages& depths, double tolerance_counts) {
  const auto min_count = std::max<std::size_t>(2, depths.size() * 4 / 5);
  return for_each_pixel(depths, min_count, [&](std::vector<std::uint16_t>& measured) {
    std::ranges::nth_element(measured, measured.begin() + 1, std::greater());
    const auto farthest = measured[1];
    const auto agreeing = std::ranges::count_if(
        measured, [&](std::uint16_t depth) { return depth >= farthest - tolerance_counts; });
    return 4 * static_cast<std::size_t>(agreeing) < measured.size() ? std::uint16_t{0} : farthest;
  });
}

std::optional<double> depth_noise_at_1m(const DepthImages& depths, double unit_m) {
  constexpr std::size_t stride = 7, min_images = 3;
  constexpr double max_noise_at_1m = 0.015, min_static_fraction = 0.05;
  std::vector<double> squares;
  for (std::size_t pixel = 0; depths.size() >= min_images && pixel < depths[0].size();
       pixel += stride) {
    double count = 0.0, sum = 0.0, square_sum = 0.0;
    for (const auto& depth : depths)
      if (const double z = unit_m * depth[pixel]; z > 0.0)
        count += 1.0, sum += z, square_sum += z * z;
    if (count < min_images) continue;
    const double mean = sum / count, variance = (square_sum - sum * mean) / (count - 1.0);
    // Wilson and Hilferty (1931): median of a chi-square distribution over its mean
    squares.push_back(variance / std::pow(mean, 4) /
                      std::pow(1.0 - 2.0 / (9.0 * (count - 1.0)), 3));
  }
  const std::size_t measured = squares.size();
  std::erase_if(squares, [](double square) { return square > max_noise_at_1m * max_noise_at_1m; });
  if (squares.empty() ||
      static_cast<double>(squares.size()) < min_static_fraction * static_cast<double>(measured))
    return std::nullopt;
  return std::sqrt(std::max(0.0, median(std::move(squares))));
}

}  // namespace touchtrace::label
