#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchtrace::label {

/// What stands before the background in a depth image, row by row. Specks are left out: of a
/// pixel's eight neighbours four must stand before it, too.
class Foreground {
 public:
  /// `limit`: counts at and beyond it are background; 0: no limit. Both images [height, width] must
  /// outlive this.
  Foreground(const std::vector<std::uint16_t>& depth, const std::vector<std::uint16_t>& limit,
             int width);

  /// Indices of pixels in row `v`. Rows are to be taken in turn, from 1 to the last but one.
  const std::vector<std::size_t>& row(std::size_t v);

 private:
  void mark(std::size_t v);
  void gather(std::size_t first);

  const std::vector<std::uint16_t>&depth_, &limit_;
  std::size_t width_;
  std::array<std::vector<std::uint8_t>, 3> before_;  ///< [width], of the last three rows
  std::vector<std::uint8_t> columns_;                ///< [width], their sum
  std::vector<std::uint8_t> clean_;                  ///< [width, rounded up to blocks]
  std::vector<std::size_t> pixels_;
};

}  // namespace touchtrace::label
