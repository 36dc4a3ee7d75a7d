#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Pressure of one frame, [rows, cols] in 0..1: counts less the baseline, more is more pressure,
/// over the converter's range 2^bits - 1; 0 where the mask has no taxel.
void pressure_of(const GloveInfo& info, std::span<const std::uint16_t> counts,
                 std::span<float> pressure);

/// Averages images over the cells of a coarser grid, by the exact area that each taxel shares with
/// each cell, so that the mean over the whole image stays what it was. Holes count as no pressure.
class AreaAverage {
 public:
  /// Throws usage_error unless 1 <= out_rows <= rows and likewise for columns.
  AreaAverage(int rows, int cols, int out_rows, int out_cols);

  /// `in` [rows, cols], `out` [out_rows, out_cols].
  void apply(std::span<const float> in, std::span<float> out) const;

 private:
  /// One axis: cell i covers `share` of the taxels from `first[i]` on.
  struct Axis {
    std::vector<int> first;
    std::vector<std::vector<float>> share;  ///< sums to 1 for each cell
  };
  static Axis divide(int taxels, int cells);

  Axis row_, col_;
  int cols_;
};

/// Of an average over the glove's taxels, [rows, cols]: 1 for cells with a share of a taxel, 0 for
/// those that are zero in every frame.
std::vector<std::uint8_t> live_cells(const GloveInfo& info, int rows, int cols);

}  // namespace touchtrace
