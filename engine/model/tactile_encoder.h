#pragma once

#include <string>

#include "engine/model/conv_stack.h"
#include "engine/model/embedding_head.h"
#include "engine/model/model_spec.h"

namespace touchtrace {

/// Convolutions of the encoder "tactile", which computes g_t from windows of M frames.
ConvStackShape window_encoder(const ModelSpec& spec, int windows, const LiveTaxels& live = {});
/// Convolutions of the encoder "object", which computes e_i from segments (section III-C).
ConvStackShape segment_encoder(const ModelSpec& spec, int segments, const LiveTaxels& live = {});

/// Encoder of tactile windows: ConvStack, then EmbeddingHead. Passes enqueue and do not wait.
class TactileEncoder {
 public:
  /// Adds the parameters "NAME.conv1.weight" ... "NAME.norm.bias" to `table`.
  static void declare(const std::string& name, const ConvStackShape& shape, int embedding,
                      ParameterTable& table);
  /// Plans a backward pass if `weights` has a gradient.
  TactileEncoder(Runtime& runtime, const std::string& name, const ConvStackShape& shape,
                 const Weights& weights);

  /// Call after every change of the weights.
  void prepare();
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout);
  /// Reads grad_embedding(). Adds to the weight gradient of the convolutions, overwrites that of
  /// the head.
  void backward();

  /// [windows] last stream frame of each window; written by the caller.
  const Buffer<int>& window_end() const { return window_end_; }
  const Buffer<float>& embedding() const { return head_.embedding(); }  ///< [windows, size]
  const Buffer<float>& grad_embedding() const { return head_.grad_embedding(); }

 private:
  Runtime& runtime_;
  ConvStack convolutions_;
  Buffer<int> window_end_;
  EmbeddingHead head_;
};

}  // namespace touchtrace
