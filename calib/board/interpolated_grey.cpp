#include "calib/board/interpolated_grey.h"

#include <cmath>

namespace touchtrace {

double interpolated_grey(const GreyImage& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x())),
            y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= image.width || y + 1 >= image.height)
    return std::numeric_limits<double>::quiet_NaN();
  const double right = pixel.x() - x, below = pixel.y() - y;
  const auto grey = [&](int column, int row) -> double {
    return image.pixels[static_cast<std::size_t>(row * image.width + column)];
  };
  return (1.0 - below) * ((1.0 - right) * grey(x, y) + right * grey(x + 1, y)) +
         below * ((1.0 - right) * grey(x, y + 1) + right * grey(x + 1, y + 1));
}

}  // namespace touchtrace
