#pragma once

namespace touchtrace {

/// Algorithm of the forward pass and the input gradient. `winograd` takes 81 multiplications
/// instead of 144 (kernels/winograd.clh). It needs kernel 3, stride 2, input in blocks, local
/// memory for the transform of one image, and Accuracy::fast; otherwise `direct` is used.
enum class Conv2dMethod { direct, winograd };

/// Configuration of a layer on KernelVariant::cpu. Configurations differ in time and in the order
/// of sums, so in the last bits of results. 0: the default for most devices.
struct Conv2dChoice {
  Conv2dMethod method = Conv2dMethod::direct;
  int accumulators = 0;     ///< direct: accumulators of 16 floats per tile
  int group_images = 0;     ///< winograd: images per work-group
  int item_tiles = 0;       ///< direct: tiles per work-item
  int gradient_images = 0;  ///< weight gradient: images per cache block
  int gradient_chunks = 0;  ///< weight gradient: partial sums over images

  bool operator==(const Conv2dChoice&) const = default;
};

}  // namespace touchtrace
