#pragma once

#include <Eigen/Core>

namespace touchtrace {

/// Regular grid of pixels that spans an image.
struct ImageGrid {
  static constexpr int columns = 9, rows = 7;
  using Mask = Eigen::Array<bool, rows, columns>;

  static Eigen::Vector2d pixel(int width, int height, int column, int row) {
    return {(width - 1.0) * column / (columns - 1), (height - 1.0) * row / (rows - 1)};
  }
};

}  // namespace touchtrace
