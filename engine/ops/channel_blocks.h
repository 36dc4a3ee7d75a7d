#pragma once

#include "engine/cl/launch.h"
#include "engine/ops/dense.h"

namespace touchtrace {

/// Two layouts of the same values between a convolution and a dense layer:
///  - images: blocks of 16 channels with a halo of zero pixels (kernels/conv2d.clh);
///  - rows: the same blocks without halo, [image][channel / 16][row][column][channel % 16].
/// A convolution with Conv2dShape::compact_output writes rows; its gradient is read from images.
/// `channels` is a multiple of 16.
struct ChannelBlocksShape {
  int images, channels, rows, cols;
  int halo = 1;

  std::size_t image_size() const;  ///< number of floats of all images, halo included
  std::size_t row_size() const;    ///< number of floats of all rows
};

/// Writes into `images` the gradient of rows first, first + 1, ... where the row's value is
/// positive, else 0: the gradient before the ReLU that made the rows.
Launch block_gradient(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& rows,
                      const Buffer<float>& row_gradient, const Buffer<float>& images,
                      int first = 0);

/// Convert rows of the dense layer's weights, [channel][row][column] each, to block order and back.
/// `shape.images` is the number of rows.
Launch to_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const MatrixView& plain,
                 const Buffer<float>& blocks);
Launch from_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocks,
                   const MatrixView& plain);

}  // namespace touchtrace
