#include "pipeline/acquire/import/gloves/glove_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr double max_count = 65535.0;
constexpr double max_incomplete = 0.1;       // of the frames
constexpr double min_fraction = 1.0 / 16.0;  // largest value of pressures from 0 to 1

void require_finite(const GloveFile& glove) {
  const auto bad = std::ranges::find_if_not(glove.values, [](float v) { return std::isfinite(v); });
  if (bad == glove.values.end()) return;
  const auto frame = static_cast<std::size_t>(bad - glove.values.begin()) / glove.taxels();
  throw data_error(fmt::format("frame {} of the glove has the value {}", frame, *bad),
                   "leave out frames without a value of each taxel");
}

/// Least power of two that is not below a positive number.
double power_of_two(double value) { return std::exp2(std::ceil(std::log2(value))); }

/// Powers of two as limits: recordings of one glove then mostly have the same scale.
ValueScale scale_of_real(double low, double high) {
  const double bottom = low < 0.0 ? -power_of_two(-low) : 0.0;
  const bool is_fraction = low >= 0.0 && high > min_fraction && high <= 1.0;
  const double top = is_fraction ? 1.0 : high > 0.0 ? power_of_two(high) : 0.0;
  const ValueScale scale{bottom, max_count / (top - bottom)};
  Progress::report(
      fmt::format("glove: values from {:g} to {:g} become counts of 16 bits: count 0 is {:g}, {:g} "
                  "counts per unit",
                  low, high, bottom, scale.counts_per_unit));
  return scale;
}

ValueScale scale_of_whole(double low, double high) {
  if (high - std::min(low, 0.0) > max_count) return scale_of_real(low, high);
  if (low >= 0.0) return {};
  Progress::report(fmt::format("glove: values from {:g} are shifted: count 0 is {:g}", low, low));
  return {low, 1.0};
}

}  // namespace

std::uint16_t ValueScale::count(double value) const {
  return static_cast<std::uint16_t>(std::clamp(std::round(scaled(value)), 0.0, max_count));
}

ValueScale value_scale(const GloveFile& glove, bool is_counts) {
  require_finite(glove);
  const auto [low, high] = std::ranges::minmax(glove.values);
  const bool is_whole =
      std::ranges::all_of(glove.values, [](float v) { return v == std::floor(v); });
  const bool is_binary = is_whole && low >= 0.0 && high == 1.0 && !is_counts;
  return is_whole && !is_binary ? scale_of_whole(low, high) : scale_of_real(low, high);
}

std::vector<std::uint16_t> counts_of(const GloveFile& glove, const ValueScale& scale) {
  std::vector<std::uint16_t> counts;
  counts.reserve(glove.values.size());
  for (const float value : glove.values) counts.push_back(scale.count(value));
  return counts;
}

void report_incomplete(const std::filesystem::path& file, std::size_t incomplete, std::size_t all) {
  if (incomplete == 0) return;
  const auto text = fmt::format("{} of {} rows have no value for some taxel", incomplete, all);
  if (static_cast<double>(incomplete) > max_incomplete * static_cast<double>(all))
    throw data_error(fmt::format("{}: {}", file.string(), text),
                     "fill them in, or leave out columns that are not taxels");
  Progress::warn(fmt::format("glove: {} and are skipped", text));
}

}  // namespace touchtrace
