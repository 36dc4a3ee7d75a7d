#include <algorithm>

#include "engine/base/integer_math.h"
#include "engine/ops/conv2d_methods.h"

namespace touchtrace {
namespace {

// Minimum number of work-items. Independent of the number of cores, so that the order of sums is,
// too.
constexpr int min_items = 32;
// Assumed usable part of a first-level cache.
constexpr int cache_bytes = 40 * 1024;

int blocks_of_input(const Conv2dShape& shape) {
  return shape.in_planes ? 1 : shape.in_channels / 16;
}

/// Number of images whose input block and two output blocks fit into the first-level cache.
int images_per_block(const Conv2dShape& shape) {
  const std::size_t in = shape.in_size() / shape.images / blocks_of_input(shape);
  const std::size_t out = shape.out_size() / shape.images / (shape.out_channels / 32);
  return std::max(1, static_cast<int>(cache_bytes / (4 * (in + out))));
}

Kernel weights_kernel(Runtime& runtime, const Conv2dShape& shape, const char* name) {
  auto defines = conv2d_defines(shape);
  defines["GROUP_IMAGES"] = std::to_string(images_per_block(shape));
  return runtime.kernel({"common.clh", "conv2d.clh", "conv2d_backward_weights.cl"}, name, defines);
}

/// Number of partial sums over images. It determines the rounding.
int chunks_of(const Conv2dShape& shape) {
  const int pairs = shape.out_channels / 32 * blocks_of_input(shape);
  return std::min(ceil_div(min_items, pairs), shape.images);
}

}  // namespace

Conv2dWeightGradient::Conv2dWeightGradient(Runtime& runtime, const Conv2dShape& shape,
                                           const Conv2dParameters& parameters)
    : runtime_(runtime), shape_(shape), parameters_(parameters), chunks_(chunks_of(shape)) {
  if (parameters.gradient.size() == 0) return;
  const auto sums = static_cast<std::size_t>(parameters.num_accumulators * chunks_);
  partial_ = runtime.allocate<float>(sums * shape.weight_size());
  partial_bias_ = runtime.allocate<float>(sums * shape.out_channels);
}

Launch Conv2dWeightGradient::sum(const Conv2dMicroBatch& batch, bool is_first) {
  const int chunk_images = ceil_div(batch.num_images, chunks_);
  return Launch(weights_kernel(runtime_, shape_, "conv2d_backward_weights"),
                range(shape_.out_channels / 32, blocks_of_input(shape_), chunks_), batch.in,
                batch.grad_out, partial_, partial_bias_, batch.num_images, chunk_images,
                batch.accumulator * chunks_, is_first ? 1 : 0)
      .with_cost(conv2d_cost(shape_, batch.num_images))
      .with_purpose(Purpose::weight_gradient);
}

Launch Conv2dWeightGradient::finish() {
  return Launch(weights_kernel(runtime_, shape_, "conv2d_reduce"),
                range(shape_.in_channels, shape_.out_channels / 32), partial_, partial_bias_,
                parameters_.num_accumulators * chunks_, parameters_.gradient, parameters_.weight_at,
                parameters_.bias_at);
}

}  // namespace touchtrace
