#include "pipeline/label/observe/color_classes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr double object_ratio = 3.0;  // of the densities of object and others
/// The same for an object with colours of the rest, over the hand, whose box shows some of the
/// rest.
constexpr double shared_object_ratio = 2.0;
constexpr double min_density = 1e-4;  // colours rarer than this belong to the rest
constexpr float arm_length_m = 0.7f;  // what is farther from the hand is not the hand's arm

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Smooths `counts` along one dimension of the grid by (1 4 1) / 6, for shades not seen yet.
std::vector<double> smoothed(const std::vector<double>& counts, std::size_t stride,
                             std::size_t levels) {
  std::vector<double> result(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::size_t level = i / stride % levels;
    const double below = level > 0 ? counts[i - stride] : counts[i];
    const double above = level + 1 < levels ? counts[i + stride] : counts[i];
    result[i] = (below + 4.0 * counts[i] + above) / 6.0;
  }
  return result;
}

/// Per-axis median of the points inside a box; nullopt if there are none.
std::optional<Eigen::Vector3f> median_in(const Surface& surface, const PixelBox& box) {
  const Surface inside = points_in(surface, box);
  if (inside.empty()) return std::nullopt;
  Eigen::Vector3f result;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& point : inside) values.push_back(point.position_m[axis]);
    result[axis] = static_cast<float>(median(std::move(values)));
  }
  return result;
}

std::uint8_t level_of(double value, double low, double high, std::size_t levels) {
  const double part = (value - low) / (high - low) * static_cast<double>(levels);
  return static_cast<std::uint8_t>(std::clamp(part, 0.0, static_cast<double>(levels) - 0.5));
}

}  // namespace

/// Levels of all colours, indexed by the sum of the channels so that similar colours share cache
/// lines.
struct ColorClasses::Levels {
  static constexpr std::size_t values = 256, sums = 3 * (values - 1) + 1;

  Levels() {
    constexpr double dark = 8.0;  // keeps the chromaticity of nearly black pixels from jumping
    for (std::size_t i = 0; i < sums; ++i) {
      const double sum = static_cast<double>(i) + 3.0 * dark;
      bright[i] = level_of(std::log(sum), std::log(24.0), std::log(789.0), brightness_levels);
      for (std::size_t value = 0; value < values; ++value)
        chroma[i][value] =
            level_of((static_cast<double>(value) + dark) / sum, 0.05, 0.85, chroma_levels);
    }
  }

  std::array<std::array<std::uint8_t, values>, sums> chroma;
  std::array<std::uint8_t, sums> bright;
};

std::size_t ColorClasses::bin(const std::array<std::uint8_t, 3>& rgb) {
  static const Levels levels;
  const auto sum = static_cast<std::size_t>(rgb[0] + rgb[1] + rgb[2]);
  const auto& chroma = levels.chroma[sum];
  return (levels.bright[sum] * chroma_levels + chroma[rgb[1]]) * chroma_levels + chroma[rgb[0]];
}

std::vector<double> ColorClasses::density(const std::vector<double>& counts, double min_total) {
  auto result = smoothed(counts, 1, chroma_levels);
  result = smoothed(result, chroma_levels, chroma_levels);
  result = smoothed(result, chroma_levels * chroma_levels, brightness_levels);
  const double total = std::max(min_total, sum(result));
  for (auto& value : result) value /= total;
  return result;
}

std::vector<bool> ColorClasses::object_bins_in_both(const Surface& surface,
                                                    const PixelBox& hand_box,
                                                    const PixelBox& object_box) {
  std::array<std::vector<double>, 4> counts;  // outside, in the hand's box, the object's, both
  counts.fill(std::vector<double>(bins));
  for (const auto& point : surface)
    counts[contains(hand_box, point) + 2u * contains(object_box, point)][bin(point.rgb)] += 1.0;
  const auto rest = density(counts[0], sum(counts[2])), object = density(counts[2], 1.0),
             both = density(counts[3], 1.0);
  std::vector<bool> of_object(bins);
  for (std::size_t i = 0; i < bins; ++i)
    of_object[i] = object[i] > std::max(object_ratio * rest[i], both[i] / object_ratio);
  return of_object;
}

void ColorClasses::learn(const Surface& surface, const PixelBox& hand_box,
                         const PixelBox& object_box, bool is_hand_inside) {
  const auto hand_m = median_in(surface, hand_box);
  const auto of_object = is_hand_inside ? object_bins_in_both(surface, hand_box, object_box)
                                        : std::vector<bool>(bins, true);
  const auto body_of = [&](const SurfacePoint& point) {
    const bool in_hand = contains(hand_box, point);
    if (contains(object_box, point) && (!in_hand || of_object[bin(point.rgb)])) return Body::object;
    return in_hand ? Body::hand : Body::rest;
  };
  for (const auto& point : surface) {
    const Body body = body_of(point);
    const bool is_far = body == Body::rest && hand_m &&
                        (point.position_m - *hand_m).squaredNorm() > arm_length_m * arm_length_m;
    auto& counts = is_far ? far_rest_ : counts_[static_cast<std::size_t>(body)];
    counts[bin(point.rgb)] += 1.0;
  }
}

void ColorClasses::learn_object_from(const Surface& near_hand) {
  auto& object = counts_[static_cast<std::size_t>(Body::object)];
  std::ranges::fill(object, 0.0);
  for (const auto& point : near_hand) object[bin(point.rgb)] += 1.0;
}

void ColorClasses::learn_hand_from(const Surface& on_hand) {
  auto& hand = counts_[static_cast<std::size_t>(Body::hand)];
  for (const auto& point : on_hand) hand[bin(point.rgb)] += 1.0;
}

void ColorClasses::build_table() {
  // without background the rest may be a few pixels of the object outside its box
  const double object_points = 1.0 + sum(counts_[2]);
  const auto far_rest = density(far_rest_, object_points), hand = density(counts_[1], 1.0),
             object = density(counts_[2], 1.0);
  auto rest = density(counts_[0], object_points);
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = std::max(rest[i], far_rest[i]);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double others = shares_rest_ ? std::max(shared_object_ratio * hand[i], min_density)
                                       : object_ratio * std::max({rest[i], hand[i], min_density});
    table_[i] = object[i] > others                         ? Body::object
                : hand[i] > std::max(rest[i], min_density) ? Body::hand
                                                           : Body::rest;
  }
  set_likeness(Body::hand, hand);
  set_likeness(Body::object, object);
}

void ColorClasses::set_likeness(Body body, const std::vector<double>& density) {
  double entropy = 0.0, total = 0.0;
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i] == body) entropy -= density[i] * std::log(density[i]), total += density[i];
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i] == body)
      likeness_[i] = static_cast<float>(std::log(density[i]) + entropy / total);
}

void ColorClasses::assign(Surface& surface) const {
  for (auto& point : surface) {
    const std::size_t i = bin(point.rgb);
    point.body = table_[i];
    point.likeness = likeness_[i];
  }
}

}  // namespace touchtrace::label
