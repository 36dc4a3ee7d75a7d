#pragma once

#include <string>

#include "engine/model/weights.h"
#include "engine/ops/channel_blocks.h"
#include "engine/ops/layer_norm.h"

namespace touchtrace {

/// The end of an encoder of touch: a dense layer from a window's features to the embedding, then
/// LayerNorm, without which the dynamics MLP hardly uses touch.
class TouchEmbedding {
 public:
  /// Adds "NAME.dense.weight" [size, F], "NAME.dense.bias", "NAME.norm.weight" and
  /// "NAME.norm.bias" [size]. F and size are multiples of 16.
  static void declare(const std::string& name, int size, const ChannelBlocksShape& features,
                      ParameterTable& table);

  /// `features` and, for a backward pass, `grad_features`, which it writes: in the rows of
  /// channel_blocks.h.
  TouchEmbedding(Runtime& runtime, const std::string& name, const Weights& weights,
                 const ChannelBlocksShape& shape, const Buffer<float>& features,
                 const Buffer<float>& grad_features);

  const Launches& prepare() const { return prepare_; }  ///< once after the weights changed
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  const Buffer<float>& embedding() const { return norm_.y; }               ///< [rows, size]
  const Buffer<float>& grad_embedding() const { return grad_embedding_; }  ///< given to backward()

 private:
  void plan_backward(Runtime& runtime, const std::string& name, const Weights& weights,
                     const MatrixView& features, const MatrixView& grad_features);

  ChannelBlocksShape weight_shape_;  ///< a row is that of one output
  MatrixView weight_;                ///< [size, F] in the order of the features
  LayerNormArrays norm_;
  Buffer<float> grad_embedding_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
