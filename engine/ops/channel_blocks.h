#pragma once

#include "engine/cl/launch.h"
#include "engine/ops/dense.h"

namespace touchtrace {

/// Images in blocks of 16 channels with a halo of zero pixels (kernels/conv2d.clh), and the rows of
/// a dense layer behind them, which keep the blocks and leave the halo out: [image][channel /
/// 16][row][column][channel % 16]. A convolution writes rows by itself
/// (Conv2dShape::compact_output); its gradient takes images. `channels` is a multiple of 16.
struct ChannelBlocksShape {
  int images, channels, rows, cols;
  int halo = 1;

  std::size_t image_size() const;  ///< floats of all images with their halo
  std::size_t row_size() const;    ///< floats of all rows
};

/// Images = gradient of rows first .. where the row is above zero: what the ReLU that made them
/// lets through.
Launch block_gradient(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& rows,
                      const Buffer<float>& row_gradient, const Buffer<float>& images,
                      int first = 0);

/// Between the parameters of the dense layer, whose rows are [channel][row][column], and rows in
/// blocks; `shape.images` is the number of rows.
Launch to_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const MatrixView& plain,
                 const Buffer<float>& blocks);
Launch from_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocks,
                   const MatrixView& plain);

}  // namespace touchtrace
