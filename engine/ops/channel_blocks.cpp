#include "engine/ops/channel_blocks.h"

namespace touchtrace {
namespace {

Kernel channel_blocks_kernel(Runtime& runtime, const ChannelBlocksShape& shape, const char* name) {
  return runtime.kernel({"common.clh", "channel_blocks.cl"}, name,
                        {{"ROWS", std::to_string(shape.rows)},
                         {"COLS", std::to_string(shape.cols)},
                         {"HALO", std::to_string(shape.halo)}});
}

int blocks_of(const ChannelBlocksShape& shape) { return shape.images * shape.channels / 16; }

}  // namespace

std::size_t ChannelBlocksShape::image_size() const {
  return static_cast<std::size_t>(images) * channels * (rows + 2 * halo) * (cols + 2 * halo);
}

std::size_t ChannelBlocksShape::row_size() const {
  return static_cast<std::size_t>(images) * channels * rows * cols;
}

Launch block_gradient(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& rows,
                      const Buffer<float>& row_gradient, const Buffer<float>& images, int first) {
  return Launch(channel_blocks_kernel(runtime, shape, "block_gradient"), range(blocks_of(shape)),
                rows, row_gradient, images, first * shape.channels / 16)
      .with_cost(0.0, 12.0 * shape.row_size());
}

Launch to_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const MatrixView& plain,
                 const Buffer<float>& blocks) {
  return Launch(channel_blocks_kernel(runtime, shape, "to_blocks"), range(blocks_of(shape)),
                plain.buffer, plain.at, blocks)
      .with_cost(0.0, 8.0 * shape.row_size());
}

Launch from_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocks,
                   const MatrixView& plain) {
  return Launch(channel_blocks_kernel(runtime, shape, "from_blocks"), range(blocks_of(shape)),
                blocks, plain.buffer, plain.at)
      .with_cost(0.0, 8.0 * shape.row_size());
}

}  // namespace touchtrace
