#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchtrace::label {

/// Foreground mask of a depth image, computed row by row. A pixel is foreground if its depth count
/// is below the background limit and so are, of the nine pixels around and including it, at least
/// three and most of those that have a measurement (removes speckles, also between holes).
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
  /// [width] of the last three rows: 1 before the background, plus 16 with a measurement.
  std::array<std::vector<std::uint8_t>, 3> marks_;
  std::vector<std::uint8_t> columns_;  ///< [width] sums over three rows
  std::vector<std::uint8_t> clean_;    ///< [width, rounded up to blocks]
  std::vector<std::size_t> pixels_;
};

}  // namespace touchtrace::label
