#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Images between blocks of 16 channels with a halo (kernels/conv2d.clh) and plain arrays
/// [image][channel][row][column]; `channels` is a multiple of 16.
struct ChannelBlocksShape {
  int images, channels, rows, cols;

  std::size_t blocked_size() const;  ///< floats with the halo
  std::size_t plain_size() const;
};

/// plain = blocked; in the plain array the images stand from `first` on.
Launch unblock(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocked,
               const Buffer<float>& plain, int first = 0);

/// blocked = plain_gradient where plain > 0: what the ReLU that made `plain` lets through.
class BlockGradient {
 public:
  BlockGradient(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& plain,
                const Buffer<float>& blocked, int first = 0);
  void enqueue(Runtime& runtime, const Buffer<float>& plain_gradient);

 private:
  Launch block_;
};

}  // namespace touchtrace
