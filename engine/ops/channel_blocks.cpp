#include "engine/ops/channel_blocks.h"

namespace touchtrace {
namespace {

Launch channel_blocks_launch(Runtime& runtime, const ChannelBlocksShape& shape, const char* name,
                             const auto&... arguments) {
  const int items = runtime.kernel_variant() == KernelVariant::gpu ? shape.rows * shape.cols : 1;
  const Defines defines{{"ROWS", std::to_string(shape.rows)},
                        {"COLS", std::to_string(shape.cols)},
                        {"HALO", std::to_string(shape.halo)},
                        {"ITEMS", std::to_string(items)}};
  return {runtime.kernel({"common.clh", "channel_blocks.cl"}, name, defines),
          range(shape.images * shape.channels / 16 * items), arguments...};
}

}  // namespace

std::size_t ChannelBlocksShape::image_size() const {
  return static_cast<std::size_t>(images) * channels * (rows + 2 * halo) * (cols + 2 * halo);
}

std::size_t ChannelBlocksShape::row_size() const {
  return static_cast<std::size_t>(images) * channels * rows * cols;
}

Launch block_gradient(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& rows,
                      const Buffer<float>& row_gradient, const Buffer<float>& images, int first) {
  return channel_blocks_launch(runtime, shape, "block_gradient", rows, row_gradient, images,
                               first * shape.channels / 16)
      .with_cost(0.0, 12.0 * shape.row_size());
}

Launch to_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const MatrixView& plain,
                 const Buffer<float>& blocks) {
  return channel_blocks_launch(runtime, shape, "to_blocks", plain.buffer, plain.at, blocks)
      .with_cost(0.0, 8.0 * shape.row_size());
}

Launch from_blocks(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocks,
                   const MatrixView& plain) {
  return channel_blocks_launch(runtime, shape, "from_blocks", blocks, plain.buffer, plain.at)
      .with_cost(0.0, 8.0 * shape.row_size());
}

}  // namespace touchtrace
