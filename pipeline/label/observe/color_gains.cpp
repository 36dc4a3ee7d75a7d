#include "pipeline/label/observe/color_gains.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t stride = 61;  // of pixels; prime, so that columns do not repeat
constexpr std::size_t min_pixels = 100;
constexpr int black = 16, saturated = 240;
constexpr double negligible = 0.01, max_gain = 4.0;

bool is_exposed(std::uint8_t value) { return value > black && value < saturated; }

}  // namespace

ColorGains color_gains(const RgbdFrame& reference, const RgbdFrame& frame) {
  ColorGains gains{1.0, 1.0, 1.0};
  const std::size_t values = std::min(reference.color.size(), frame.color.size());
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::vector<double> ratios;
    for (std::size_t i = channel; i < values; i += 3 * stride)
      if (is_exposed(reference.color[i]) && is_exposed(frame.color[i]))
        ratios.push_back(static_cast<double>(frame.color[i]) / reference.color[i]);
    if (ratios.size() >= min_pixels)
      gains[channel] = std::clamp(median(std::move(ratios)), 1.0 / max_gain, max_gain);
  }
  return gains;
}

void normalize_colors(const ColorGains& gains, RgbdFrame& frame) {
  if (std::ranges::all_of(gains, [](double gain) { return std::abs(gain - 1.0) < negligible; }))
    return;
  std::array<std::array<std::uint8_t, 256>, 3> table;
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t value = 0; value < 256; ++value)
      table[channel][value] = static_cast<std::uint8_t>(
          std::min(255.0, std::round(static_cast<double>(value) / gains[channel])));
  for (std::size_t i = 0; i + 2 < frame.color.size(); i += 3)
    for (std::size_t channel = 0; channel < 3; ++channel)
      frame.color[i + channel] = table[channel][frame.color[i + channel]];
}

}  // namespace touchtrace::label
