#pragma once

#include <vector>

#include "engine/ops/conv2d.h"

namespace touchtrace {

/// The -D that kernels/conv2d.clh wants in backward passes, and in forward ones.
Defines conv2d_defines(const Conv2dShape& shape);
Defines conv2d_forward_defines(const Conv2dShape& shape);
/// Of one pass over some of the shape's images.
LaunchCost conv2d_cost(const Conv2dShape& shape, int images);

std::unique_ptr<Conv2d> make_conv2d_direct(Runtime& runtime, const Conv2dShape& shape,
                                           const Conv2dParameters& parameters,
                                           const Conv2dChoice& choice);
std::unique_ptr<Conv2d> make_conv2d_winograd(Runtime& runtime, const Conv2dShape& shape,
                                             const Conv2dParameters& parameters,
                                             const Conv2dChoice& choice);
/// The body of GPUs; `shape` as both methods take it.
std::unique_ptr<Conv2d> make_conv2d_gpu(Runtime& runtime, const Conv2dShape& shape,
                                        const Conv2dParameters& parameters);

/// Whether the method computes such a layer at all.
bool winograd_applies(const Conv2dShape& shape);
/// Images whose points stand in the device's local memory together; 0: not one does.
int winograd_group(const Runtime& runtime, const Conv2dShape& shape, const Conv2dChoice& choice);

/// The gradient of weight and bias, which the methods share (kernels/conv2d_backward_weights.cl).
class Conv2dWeightsGradient {
 public:
  /// Allocates nothing if there is no gradient.
  Conv2dWeightsGradient(Runtime& runtime, const Conv2dShape& shape,
                        const Conv2dParameters& parameters, const Conv2dChoice& choice);

  Launch sum(const Conv2dImages& part, bool first);
  Launch finish();

 private:
  Runtime& runtime_;
  Conv2dShape shape_;
  Conv2dParameters parameters_;
  Conv2dChoice choice_;
  int chunks_;
  Buffer<float> partial_, partial_bias_;
};

// What each method offers to a tuner, its usual numbers first; the last, numbers of the weights'
// gradient alone.
std::vector<Conv2dChoice> direct_candidates();
std::vector<Conv2dChoice> winograd_candidates(const Runtime& runtime, const Conv2dShape& shape);
std::vector<Conv2dChoice> gradient_candidates(const Conv2dShape& shape);

}  // namespace touchtrace
