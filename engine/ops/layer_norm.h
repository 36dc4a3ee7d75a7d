#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Arrays of a LayerNorm over rows of `columns` values, a multiple of 16.
struct LayerNormArrays {
  int rows, columns;
  Buffer<float> parameters;
  int gain_at, bias_at;      ///< offsets in `parameters` and in its gradient
  Buffer<float> x, y;        ///< [rows, columns]
  Buffer<float> statistics;  ///< [rows, 2]: mean and 1 / standard deviation
};

/// `x` and `y` must not be one buffer: on GPUs, work-items past the end repeat the last row.
Launch layer_norm(Runtime& runtime, const LayerNormArrays& arrays);
/// Computes grad_x from grad_y, both [rows, columns], which must not be one buffer.
Launch layer_norm_backward(Runtime& runtime, const LayerNormArrays& arrays,
                           const Buffer<float>& grad_y, const Buffer<float>& grad_x);
/// Writes the gradients of gain and bias into the flat `gradient`.
Launch layer_norm_weights(Runtime& runtime, const LayerNormArrays& arrays,
                          const Buffer<float>& grad_y, const Buffer<float>& gradient);

}  // namespace touchtrace
