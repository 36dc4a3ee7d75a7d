#pragma once

#include <memory>
#include <string>

#include "engine/cl/runtime.h"
#include "engine/model/conv_stack_shape.h"
#include "engine/model/weights.h"
#include "engine/ops/conv2d.h"

namespace touchtrace {

/// Convolutions of a tactile encoder, each with bias and ReLU, over windows of M frames in the
/// difference basis of tactile_window.h. Windows are gathered from the frame stream on the device.
/// Passes enqueue and do not wait.
///
/// Windows are processed in micro-batches of micro_batch_windows: each goes through all layers, so
/// that the output of one layer is still in the cache when the next reads it. Micro-batches
/// alternate between two queues. On GPUs, where a launch needs many windows, micro-batches have
/// gpu_micro_batch_windows.
class ConvStack {
 public:
  static constexpr int micro_batch_windows = 32, gpu_micro_batch_windows = 1024;

  /// Adds "NAME.conv1.weight" [32, M, kernel, kernel], "NAME.conv1.bias" [32], ... to `table`,
  /// initialised as PyTorch initialises convolutions (uniform within 1/sqrt(fan in)).
  static void declare(const std::string& name, const ConvStackShape& shape, ParameterTable& table);

  /// Plans a backward pass if `weights` has a gradient. A prediction does not depend on the number
  /// of windows, not even in the last bit.
  ConvStack(Runtime& runtime, const std::string& name, const ConvStackShape& shape,
            const Weights& weights);
  ~ConvStack();

  /// Output in the row layout of channel_blocks.h; valid after forward().
  const Buffer<float>& features() const;
  /// Gradient with respect to features(); read by backward().
  const Buffer<float>& grad_features() const;

  void prepare();  ///< call after every change of the weights
  /// `stream`: [frames, rows, cols]. `window_end`: [windows]; window w holds the frames
  /// window_end[w] - M + 1 .. window_end[w], which must exist in the stream.
  void forward(const Buffer<float>& stream, const Buffer<int>& window_end,
               const TaxelDropout& dropout = {});
  /// Adds the gradients of weights and biases of the last forward pass to the weight gradient,
  /// which the caller zeroes. Sums have a fixed order.
  void backward();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchtrace
