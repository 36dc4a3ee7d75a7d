#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/ops/channel_blocks.h"
#include "engine/ops/conv2d.h"
#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// [rows, cols] 0 for taxels that are zero in every frame, else 1; empty: unknown.
using LiveTaxels = std::vector<std::uint8_t>;

/// Live taxels of a stream [frames, taxels].
LiveTaxels live_taxels(std::span<const float> stream, std::size_t taxels);

/// Tactile windows and three convolutions over them, with 32, 64 and 128 channels. The paper
/// (section III-B) has kernels of 3 and strides of 2.
struct ConvStackShape {
  TactileWindowShape windows;  ///< `halo` is ignored: it follows from the kernel
  int kernel = 3;              ///< of all three: 3 or 5
  std::array<int, 3> strides{2, 2, 2};
  LiveTaxels live = {};

  /// Shapes of the three layers. The first one skips its dead output pixels if there are enough of
  /// them. Throws usage_error for frames outside 1..64 or M outside 1..32.
  std::array<Conv2dShape, 3> layers() const;
  /// Same convolutions over another number of windows.
  ConvStackShape of_windows(int count) const;
  /// Output of the last layer.
  ChannelBlocksShape features() const;
};

}  // namespace touchtrace
