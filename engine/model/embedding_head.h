#pragma once

#include <string>

#include "engine/model/weights.h"
#include "engine/ops/channel_blocks.h"
#include "engine/ops/layer_norm.h"

namespace touchtrace {

/// Head of a tactile encoder: dense layer from the features of a window to its embedding, then
/// LayerNorm, without which the dynamics MLP hardly uses touch.
class EmbeddingHead {
 public:
  /// Adds "NAME.dense.weight" [size, F], "NAME.dense.bias", "NAME.norm.weight" and
  /// "NAME.norm.bias" [size]. F and size are multiples of 16.
  static void declare(const std::string& name, int size, const ChannelBlocksShape& features,
                      ParameterTable& table);

  /// `features`: input. `grad_features`: written by backward(). Both have the row layout of
  /// channel_blocks.h.
  EmbeddingHead(Runtime& runtime, const std::string& name, const Weights& weights,
                const ChannelBlocksShape& shape, const Buffer<float>& features,
                const Buffer<float>& grad_features);

  const Launches& prepare() const { return prepare_; }  ///< after every change of the weights
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  const Buffer<float>& embedding() const { return norm_.y; }               ///< [rows, size]
  const Buffer<float>& grad_embedding() const { return grad_embedding_; }  ///< read by backward()

 private:
  void plan_backward(Runtime& runtime, const std::string& name, const Weights& weights,
                     const MatrixView& features, const MatrixView& grad_features);

  ChannelBlocksShape weight_shape_;  ///< one image per output
  MatrixView weight_;                ///< [size, F] in the order of the features
  LayerNormArrays norm_;
  Buffer<float> grad_embedding_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
