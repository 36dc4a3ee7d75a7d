#include "engine/ops/conv2d.h"

#include <algorithm>

namespace touchtrace {
namespace {

// Tiles as the kernels define them, and how much work an item should do at least, since a
// work-group of one item costs a CPU runtime about as much as 200 vector operations.
constexpr int pixels_a_tile = 12, quads_a_tile = 3, images_a_group = 4;
constexpr int wanted_vector_operations = 20000;
constexpr int wanted_items = 32;

int ceil_div(int a, int b) { return (a + b - 1) / b; }

cl::Kernel conv2d_kernel(Runtime& runtime, const Conv2dShape& shape, const char* name) {
  Defines defines{{"IN_CHANNELS", std::to_string(shape.in_channels)},
                  {"OUT_CHANNELS", std::to_string(shape.out_channels)},
                  {"IN_ROWS", std::to_string(shape.rows)},
                  {"IN_COLS", std::to_string(shape.cols)},
                  {"PIXELS", std::to_string(pixels_a_tile)},
                  {"QUADS", std::to_string(quads_a_tile)},
                  {"GROUP", std::to_string(images_a_group)}};
  if (shape.in_planes) defines["IN_PLANES"] = "1";
  return runtime.kernel({"common.clh", "conv2d.clh", "conv2d_forward.cl", "conv2d_backward_data.cl",
                         "conv2d_backward_weights.cl"},
                        name, defines);
}

int pixels(const Conv2dShape& shape) { return shape.images * shape.out_rows() * shape.out_cols(); }

int in_blocks(const Conv2dShape& shape) { return shape.in_planes ? 1 : shape.in_channels / 16; }

/// As many chunks as give every core work, and no more than there are groups of images.
Conv2dChunks chunks_of(const Conv2dShape& shape) {
  const int wanted = ceil_div(wanted_items, shape.out_channels / 32 * in_blocks(shape));
  const int images = ceil_div(ceil_div(shape.images, wanted), images_a_group) * images_a_group;
  return {ceil_div(shape.images, images), images};
}

/// A launch over `tiles` tiles for each of `pairs` pairs of blocks; the last argument of the kernel
/// is how many tiles an item does.
template <class... Arguments>
Launch tiled_launch(Runtime& runtime, const Conv2dShape& shape, const char* name, int tiles,
                    int pairs, int operations_a_tile, const Arguments&... arguments) {
  const bool cpu = runtime.device().type == "cpu";
  const int run = cpu ? ceil_div(wanted_vector_operations, operations_a_tile) : 1;
  return Launch(conv2d_kernel(runtime, shape, name), range(ceil_div(tiles, run), pairs),
                arguments..., run);
}

/// Packs the weights with output (input) channels as lanes; argument 0, the parameters, is set when
/// queued.
Launch pack_launch(Runtime& runtime, const Conv2dShape& shape, int weight_at,
                   bool lanes_are_outputs, const Buffer<float>& packed) {
  const int out_stride = shape.in_channels * 9, in_stride = 9;
  const int lanes = lanes_are_outputs ? shape.out_channels : shape.in_channels;
  const int channels = lanes_are_outputs ? shape.in_channels : shape.out_channels;
  return Launch(conv2d_kernel(runtime, shape, "conv2d_pack"), range(channels, lanes / 32), packed,
                weight_at, lanes_are_outputs ? out_stride : in_stride,
                lanes_are_outputs ? in_stride : out_stride, packed);
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
      pack_(pack_launch(runtime, shape, places.weight_at, true, packed_)),
      convolve_(tiled_launch(runtime, shape, "conv2d_forward",
                             ceil_div(pixels(shape), pixels_a_tile), shape.out_channels / 32,
                             shape.in_channels * 9 * pixels_a_tile * 2, in, packed_, packed_,
                             places.bias_at, out, shape.images)) {}

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
      pack_(pack_launch(runtime, shape, places.weight_at, false, packed_)),
      gather_(tiled_launch(runtime, shape, "conv2d_backward_data",
                           ceil_div(pixels(shape), quads_a_tile), shape.in_channels / 32,
                           shape.out_channels * 9 * quads_a_tile * 2, grad_out, packed_, in,
                           grad_in, shape.images)) {}

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
      sum_(conv2d_kernel(runtime, shape, "conv2d_backward_weights"),
           range(shape.out_channels / 32, in_blocks(shape), chunks_.count), in, grad_out, partial_,
           partial_bias_, shape.images, chunks_.images),
      reduce_(conv2d_kernel(runtime, shape, "conv2d_reduce"),
              range(shape.in_channels, shape.out_channels / 32), partial_, partial_bias_,
              chunks_.count, partial_, places.weight_at, places.bias_at) {}

void Conv2dBackwardWeights::enqueue(Runtime& runtime, const Buffer<float>& gradient) {
  reduce_.set(3, gradient);
  sum_.enqueue(runtime);
  reduce_.enqueue(runtime);
}

}  // namespace touchtrace
