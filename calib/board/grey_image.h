#pragma once

#include <cstdint>
#include <vector>

namespace touchtrace {

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< [height, width]
};

}  // namespace touchtrace
