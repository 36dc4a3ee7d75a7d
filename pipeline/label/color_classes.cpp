#include "pipeline/label/color_classes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchtrace::label {
namespace {

/// `counts` over a cube of colours, smoothed along each channel by (1 4 1) / 6: shades not yet
/// seen.
std::vector<double> smoothed(const std::vector<double>& counts, std::size_t levels) {
  std::vector<double> now = counts;
  for (std::size_t stride : {std::size_t{1}, levels, levels * levels}) {
    std::vector<double> next(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      const std::size_t level = i / stride % levels;
      const double below = level > 0 ? now[i - stride] : now[i];
      const double above = level + 1 < levels ? now[i + stride] : now[i];
      next[i] = (below + 4.0 * now[i] + above) / 6.0;
    }
    now = std::move(next);
  }
  return now;
}

/// Relative frequencies; every bin gets a little, so that an unseen colour is the rest's.
std::vector<double> density(const std::vector<double>& counts, std::size_t levels, double floor) {
  auto result = smoothed(counts, levels);
  const double total = std::max(1.0, std::accumulate(result.begin(), result.end(), 0.0));
  for (auto& value : result) value = value / total + floor;
  return result;
}

}  // namespace

void ColorClasses::learn(const Surface& surface, const PixelBox& hand_box,
                         const PixelBox& object_box) {
  for (const auto& point : surface) {
    const Body body = contains(object_box, point) ? Body::object
                      : contains(hand_box, point) ? Body::hand
                                                  : Body::rest;
    counts_[static_cast<std::size_t>(body)][bin(point.rgb)] += 1.0;
  }
}

void ColorClasses::settle() {
  const auto rest = density(counts_[0], levels, 1e-4), hand = density(counts_[1], levels, 5e-5),
             object = density(counts_[2], levels, 5e-5);
  for (std::size_t i = 0; i < table_.size(); ++i)
    table_[i] = object[i] > hand[i] && object[i] > rest[i] ? Body::object
                : hand[i] > rest[i]                        ? Body::hand
                                                           : Body::rest;
}

void ColorClasses::assign(Surface& surface) const {
  for (auto& point : surface) point.body = of(point.rgb);
}

}  // namespace touchtrace::label
