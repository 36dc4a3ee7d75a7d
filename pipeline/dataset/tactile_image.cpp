#include "pipeline/dataset/tactile_image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace touchtrace {

ImageShape image_shape(const GloveInfo& info, int resolution) {
  constexpr int default_resolution = 32;
  if (resolution > 0) return {resolution, resolution};
  const bool is_small = std::min(info.rows, info.cols) < default_resolution;
  if (resolution == own_resolution || is_small) return {info.rows, info.cols};
  return {default_resolution, default_resolution};
}

void counts_to_pressure(const GloveInfo& info, std::span<const std::uint16_t> counts,
                        std::span<float> pressure) {
  const auto range = static_cast<float>((1 << info.bits) - 1);
  const auto sign = static_cast<float>(info.polarity);
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    const float value = sign * (static_cast<float>(counts[i]) - info.baseline_counts[i]) / range;
    pressure[i] = info.mask[i] ? std::clamp(value, 0.0f, 1.0f) : 0.0f;
  }
}

AreaAverage::Axis AreaAverage::divide(int taxels, int cells) {
  if (cells < 1 || cells > taxels)
    throw usage_error(
        fmt::format("a resolution of {} does not fit the glove, which has {} taxels along an axis",
                    cells, taxels),
        fmt::format("give --resolution {} or less, or a model that was trained with it", taxels));
  Axis axis;
  const double width = static_cast<double>(taxels) / cells;
  for (int cell = 0; cell < cells; ++cell) {
    const double start = cell * width, end = cell + 1 == cells ? taxels : (cell + 1) * width;
    const int first = static_cast<int>(start);
    axis.first.push_back(first);
    auto& weights = axis.weights.emplace_back();
    for (int taxel = first; taxel < end; ++taxel) {
      const double overlap = std::min<double>(taxel + 1, end) - std::max<double>(taxel, start);
      weights.push_back(static_cast<float>(overlap / width));
    }
  }
  return axis;
}

AreaAverage::AreaAverage(int rows, int cols, int out_rows, int out_cols)
    : row_(divide(rows, out_rows)), col_(divide(cols, out_cols)), cols_(cols) {}

void AreaAverage::apply(std::span<const float> in, std::span<float> out) const {
  auto cell = out.begin();
  for (std::size_t r = 0; r < row_.first.size(); ++r)
    for (std::size_t c = 0; c < col_.first.size(); ++c) {
      float sum = 0.0f;
      for (std::size_t i = 0; i < row_.weights[r].size(); ++i) {
        const auto from = (row_.first[r] + i) * cols_ + col_.first[c];
        for (std::size_t j = 0; j < col_.weights[c].size(); ++j)
          sum += row_.weights[r][i] * col_.weights[c][j] * in[from + j];
      }
      *cell++ = sum;
    }
}

std::vector<std::uint8_t> live_cells(const GloveInfo& info, int rows, int cols) {
  const std::vector<float> mask(info.mask.begin(), info.mask.end());
  std::vector<float> coverage(std::size_t(rows) * cols);
  AreaAverage(info.rows, info.cols, rows, cols).apply(mask, coverage);
  std::vector<std::uint8_t> live;
  for (const float cell : coverage) live.push_back(cell > 0.0f);
  return live;
}

}  // namespace touchtrace
