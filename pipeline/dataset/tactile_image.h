#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

struct ImageShape {
  int rows, cols;
};

/// Keeps the glove's rows and columns.
inline constexpr int own_resolution = -1;

/// Shape of the images of a glove at a resolution: `resolution` rows and columns; 0: 32, or the
/// glove's own if it has fewer along an axis; or own_resolution.
ImageShape image_shape(const GloveInfo& info, int resolution);

/// Converts one frame [rows, cols]: polarity * (counts - baseline) / (2^bits - 1), clamped to 0..1;
/// 0 where the mask has no taxel.
void counts_to_pressure(const GloveInfo& info, std::span<const std::uint16_t> counts,
                        std::span<float> pressure);

/// Area-weighted downsampling of tactile images, which preserves the mean of the image. Missing
/// taxels count as pressure 0.
class AreaAverage {
 public:
  /// Throws usage_error unless 1 <= out_rows <= rows and likewise for columns.
  AreaAverage(int rows, int cols, int out_rows, int out_cols);

  /// `in` [rows, cols], `out` [out_rows, out_cols].
  void apply(std::span<const float> in, std::span<float> out) const;

 private:
  /// Weights of one axis: cell i averages taxels from first[i] on with weights[i], which sum to 1.
  struct Axis {
    std::vector<int> first;
    std::vector<std::vector<float>> weights;
  };
  static Axis divide(int taxels, int cells);

  Axis row_, col_;
  int cols_;
};

/// Mask [rows, cols] of the downsampled image: 1 for cells that overlap a taxel. The others are 0
/// in every frame.
std::vector<std::uint8_t> live_cells(const GloveInfo& info, int rows, int cols);

}  // namespace touchtrace
