#include "engine/ops/channel_blocks.h"

namespace touchtrace {
namespace {

cl::Kernel channel_blocks_kernel(Runtime& runtime, const ChannelBlocksShape& shape,
                                 const char* name) {
  return runtime.kernel(
      {"common.clh", "channel_blocks.cl"}, name,
      {{"ROWS", std::to_string(shape.rows)}, {"COLS", std::to_string(shape.cols)}});
}

cl::NDRange blocks(const ChannelBlocksShape& shape) {
  return range(shape.images * shape.channels / 16);
}

}  // namespace

std::size_t ChannelBlocksShape::blocked_size() const {
  return static_cast<std::size_t>(images) * channels * (rows + 2) * (cols + 2);
}

std::size_t ChannelBlocksShape::plain_size() const {
  return static_cast<std::size_t>(images) * channels * rows * cols;
}

Launch unblock(Runtime& runtime, const ChannelBlocksShape& shape, const Buffer<float>& blocked,
               const Buffer<float>& plain, int first) {
  return Launch(channel_blocks_kernel(runtime, shape, "unblock"), blocks(shape), blocked, plain,
                first * shape.channels / 16);
}

BlockGradient::BlockGradient(Runtime& runtime, const ChannelBlocksShape& shape,
                             const Buffer<float>& plain, const Buffer<float>& blocked, int first)
    : block_(channel_blocks_kernel(runtime, shape, "block_gradient"), blocks(shape), plain, plain,
             blocked, first * shape.channels / 16) {}

void BlockGradient::enqueue(Runtime& runtime, const Buffer<float>& plain_gradient) {
  block_.set(1, plain_gradient);
  block_.enqueue(runtime);
}

}  // namespace touchtrace
