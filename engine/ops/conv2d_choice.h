#pragma once

namespace touchtrace {

/// `winograd`: 81 multiplications instead of 144 in the forward pass and the gradient towards the
/// input (kernels/winograd.clh), if the kernel is 3 and the stride 2, the input is in blocks, the
/// device's local memory holds the points of one image, and the runtime's accuracy is
/// Accuracy::fast; otherwise `direct`.
enum class Conv2dMethod { direct, winograd };

/// How the body `vectors` computes a layer where several ways are right: they differ in time, and
/// in the order of sums and so in the last bits. A number of 0 is left to the rule that suits most
/// devices.
struct Conv2dChoice {
  Conv2dMethod method = Conv2dMethod::direct;
  int accumulators = 0;     ///< direct: vectors of 16 sums in registers
  int group_images = 0;     ///< winograd: images whose points stand in local memory together
  int item_tiles = 0;       ///< direct: tiles that a work-item does one after the other
  int gradient_images = 0;  ///< weights' gradient: images that stay in the cache over all channels
  int gradient_chunks = 0;  ///< weights' gradient: sums over images that are kept apart

  bool operator==(const Conv2dChoice&) const = default;
};

}  // namespace touchtrace
