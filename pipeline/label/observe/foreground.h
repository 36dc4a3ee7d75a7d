#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchtrace::label {

/// Foreground mask of a depth image, computed row by row. A pixel is foreground if its depth count
/// is below the background limit and at least four of its eight neighbours are, too (removes
/// speckles).
class Foreground {
 public:
  /// `limit`: smallest background count per pixel; 0: no limit. Both images [height, width] must
  /// outlive this object.
  Foreground(const std::vector<std::uint16_t>& depth, const std::vector<std::uint16_t>& limit,
             int width);

  /// Indices of the foreground pixels in row `v`. Rows must be requested in order, from 1 to
  /// height - 2.
  const std::vector<std::size_t>& row(std::size_t v);

 private:
  void mark(std::size_t v);
  void gather(std::size_t first);

  const std::vector<std::uint16_t>&depth_, &limit_;
  std::size_t width_;
  std::array<std::vector<std::uint8_t>, 3> before_;  ///< [width] of the last three rows
  std::vector<std::uint8_t> columns_;                ///< [width] sums over three rows
  std::vector<std::uint8_t> clean_;                  ///< [width, rounded up to blocks]
  std::vector<std::size_t> pixels_;
};

}  // namespace touchtrace::label
