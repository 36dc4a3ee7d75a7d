#include "engine/ops/conv2d.h"

#include <algorithm>

namespace touchtrace {
namespace {

// How much work an item should do at least, since a work-group of one item costs a CPU runtime
// about as much as 200 vector operations; and how many items there should be at least.
constexpr int wanted_vector_operations = 20000;
constexpr int wanted_items = 32;
// What stays in a first-level cache.
constexpr int cache_bytes = 40 * 1024;

int ceil_div(int a, int b) { return (a + b - 1) / b; }

Defines shape_defines(const Conv2dShape& shape) {
  Defines defines{{"IN_CHANNELS", std::to_string(shape.in_channels)},
                  {"OUT_CHANNELS", std::to_string(shape.out_channels)},
                  {"IN_ROWS", std::to_string(shape.rows)},
                  {"IN_COLS", std::to_string(shape.cols)}};
  if (shape.in_planes) defines.emplace("IN_PLANES", "1");
  return defines;
}

int pixels(const Conv2dShape& shape) { return shape.images * shape.out_rows() * shape.out_cols(); }

int in_blocks(const Conv2dShape& shape) { return shape.in_planes ? 1 : shape.in_channels / 16; }

/// Images whose block of input channels and pair of output blocks a first-level cache holds.
int group_images(const Conv2dShape& shape) {
  const std::size_t in = shape.in_size() / shape.images / in_blocks(shape);
  const std::size_t out = shape.out_size() / shape.images / (shape.out_channels / 32);
  return std::max(1, static_cast<int>(cache_bytes / (4 * (in + out))));
}

cl::Kernel weights_kernel(Runtime& runtime, const Conv2dShape& shape, const char* name) {
  auto defines = shape_defines(shape);
  defines["GROUP"] = std::to_string(group_images(shape));
  return runtime.kernel({"common.clh", "conv2d.clh", "conv2d_backward_weights.cl"}, name, defines);
}

/// As many chunks as give every core work.
Conv2dChunks chunks_of(const Conv2dShape& shape) {
  const int wanted = ceil_div(wanted_items, shape.out_channels / 32 * in_blocks(shape));
  const int images = ceil_div(shape.images, std::min(wanted, shape.images));
  return {ceil_div(shape.images, images), images};
}

/// One of the two passes that multiply tiles of 24 accumulators: the forward pass, with output
/// channels as lanes, or the gradient towards the input, the other way round.
struct TiledPass {
  const char* file;
  int lanes, channels, lane_stride, channel_stride;
  int blocks;       ///< of 16 lanes in a tile
  int tile_pixels;  ///< output pixels in a tile

  int groups() const { return lanes / 16 / blocks; }
};

TiledPass forward_pass(const Conv2dShape& s) {
  const int blocks = s.out_channels % 64 == 0 ? 4 : 2;
  return {"conv2d_forward.cl", s.out_channels, s.in_channels, s.in_channels * 9, 9, blocks,
          24 / blocks};
}

TiledPass data_pass(const Conv2dShape& s) {
  return {"conv2d_backward_data.cl", s.in_channels, s.out_channels, 9, s.in_channels * 9, 2, 3};
}

cl::Kernel tiled_kernel(Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass,
                        const std::string& name) {
  auto defines = shape_defines(shape);
  defines["BLOCKS"] = std::to_string(pass.blocks);
  return runtime.kernel({"common.clh", "conv2d.clh", "conv2d_pack.cl", pass.file}, name, defines);
}

/// Tiles that a work-item does one after the other.
int tiles_an_item(const Runtime& runtime, const TiledPass& pass) {
  const int operations = pass.channels * 9 * pass.tile_pixels * pass.blocks;
  return runtime.device().type == "cpu" ? ceil_div(wanted_vector_operations, operations) : 1;
}

int items(const Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass) {
  return ceil_div(ceil_div(pixels(shape), pass.tile_pixels), tiles_an_item(runtime, pass));
}

/// Argument 0, the parameters, is set when queued.
Launch pack_launch(Runtime& runtime, const Conv2dShape& shape, const TiledPass& pass, int weight_at,
                   const Buffer<float>& packed) {
  return Launch(tiled_kernel(runtime, shape, pass, "conv2d_pack"),
                range(pass.channels, pass.groups()), packed, weight_at, pass.lane_stride,
                pass.channel_stride, packed);
}

std::size_t weight_size(const Conv2dShape& shape) {
  return static_cast<std::size_t>(shape.out_channels) * shape.in_channels * 9;
}

}  // namespace

std::size_t Conv2dShape::in_size() const {
  return static_cast<std::size_t>(images) * in_channels * (rows + 2) * (cols + 2);
}

std::size_t Conv2dShape::out_size() const {
  return static_cast<std::size_t>(images) * out_channels * (out_rows() + 2) * (out_cols() + 2);
}

double Conv2dShape::flops() const {
  return 18.0 * images * in_channels * out_channels * out_rows() * out_cols();
}

Conv2dForward::Conv2dForward(Runtime& runtime, const Conv2dShape& shape, Conv2dPlaces places,
                             const Buffer<float>& in, const Buffer<float>& out)
    : packed_(runtime.allocate<float>(weight_size(shape))),
      pack_(pack_launch(runtime, shape, forward_pass(shape), places.weight_at, packed_)),
      convolve_(tiled_kernel(runtime, shape, forward_pass(shape), "conv2d_forward"),
                range(items(runtime, shape, forward_pass(shape)), forward_pass(shape).groups()), in,
                packed_, packed_, places.bias_at, out, shape.images,
                tiles_an_item(runtime, forward_pass(shape))) {}

void Conv2dForward::enqueue(Runtime& runtime, const Buffer<float>& parameters) {
  pack_.set(0, parameters);
  convolve_.set(2, parameters);
  pack_.enqueue(runtime);
  convolve_.enqueue(runtime);
}

Conv2dBackwardData::Conv2dBackwardData(Runtime& runtime, const Conv2dShape& shape,
                                       Conv2dPlaces places, const Buffer<float>& in,
                                       const Buffer<float>& grad_out, const Buffer<float>& grad_in)
    : packed_(runtime.allocate<float>(weight_size(shape))),
      pack_(pack_launch(runtime, shape, data_pass(shape), places.weight_at, packed_)),
      gather_(tiled_kernel(runtime, shape, data_pass(shape), "conv2d_backward_data"),
              range(items(runtime, shape, data_pass(shape)), data_pass(shape).groups()), grad_out,
              packed_, in, grad_in, shape.images, tiles_an_item(runtime, data_pass(shape))) {}

void Conv2dBackwardData::enqueue(Runtime& runtime, const Buffer<float>& parameters) {
  pack_.set(0, parameters);
  pack_.enqueue(runtime);
  gather_.enqueue(runtime);
}

Conv2dBackwardWeights::Conv2dBackwardWeights(Runtime& runtime, const Conv2dShape& shape,
                                             Conv2dPlaces places, const Buffer<float>& in,
                                             const Buffer<float>& grad_out)
    : chunks_(chunks_of(shape)),
      partial_(runtime.allocate<float>(chunks_.count * weight_size(shape))),
      partial_bias_(
          runtime.allocate<float>(static_cast<std::size_t>(chunks_.count) * shape.out_channels)),
      sum_(weights_kernel(runtime, shape, "conv2d_backward_weights"),
           range(shape.out_channels / 32, in_blocks(shape), chunks_.count), in, grad_out, partial_,
           partial_bias_, shape.images, chunks_.images),
      reduce_(weights_kernel(runtime, shape, "conv2d_reduce"),
              range(shape.in_channels, shape.out_channels / 32), partial_, partial_bias_,
              chunks_.count, partial_, places.weight_at, places.bias_at) {}

void Conv2dBackwardWeights::enqueue(Runtime& runtime, const Buffer<float>& gradient) {
  reduce_.set(3, gradient);
  sum_.enqueue(runtime);
  reduce_.enqueue(runtime);
}

}  // namespace touchtrace
