#pragma once

#include <cstdint>

namespace touchtrace {

/// Blanks a share of the taxels, the same ones in all frames of a window, and divides the others by
/// 1 - share. Which ones follows from a hash of (key, window, taxel); draw a new key every update.
struct TaxelDropout {
  double share = 0.0;  ///< 0: nothing is blanked
  std::uint32_t key = 0;
};

}  // namespace touchtrace
