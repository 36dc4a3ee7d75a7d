#pragma once

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// -D options of kernels/conv2d.clh for backward and for forward passes.
Defines conv2d_defines(const Conv2dShape& shape);
Defines conv2d_forward_defines(const Conv2dShape& shape);
/// Cost of one pass over `images` of the shape's images.
LaunchCost conv2d_cost(const Conv2dShape& shape, int images);

/// As make_conv2d(), for the variants of KernelVariant::cpu.
std::unique_ptr<Conv2d> make_conv2d_direct(Runtime& runtime, const Conv2dShape& shape,
                                           const Conv2dParameters& parameters);
std::unique_ptr<Conv2d> make_conv2d_winograd(Runtime& runtime, const Conv2dShape& shape,
                                             const Conv2dParameters& parameters);
/// As make_conv2d(), for KernelVariant::gpu.
std::unique_ptr<Conv2d> make_conv2d_gpu(Runtime& runtime, const Conv2dShape& shape,
                                        const Conv2dParameters& parameters);

/// Whether the shape suits Winograd's method.
bool winograd_applies(const Conv2dShape& shape);
/// Images per work-group; 0: local memory does not hold the transform of one image.
int winograd_group(const Runtime& runtime, const Conv2dShape& shape);

/// Gradient of weight and bias, shared by the methods (kernels/conv2d_backward_weights.cl).
class Conv2dWeightGradient {
 public:
  /// Allocates nothing if parameters.gradient is empty.
  Conv2dWeightGradient(Runtime& runtime, const Conv2dShape& shape,
                       const Conv2dParameters& parameters);

  /// Adds the micro-batch's gradient to its accumulator, or overwrites it if `is_first`.
  Launch sum(const Conv2dMicroBatch& batch, bool is_first);
  /// Adds the accumulators to Conv2dParameters::gradient.
  Launch finish();

 private:
  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  int chunks_;
  Buffer<float> partial_, partial_bias_;
};

}  // namespace touchtrace
