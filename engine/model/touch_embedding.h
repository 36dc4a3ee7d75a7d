#pragma once

#include "engine/model/model_spec.h"
#include "engine/model/weights.h"
#include "engine/ops/layer_norm.h"

namespace touchtrace {

/// The end of the tactile encoder: a dense layer from a window's features to the embedding g_t,
/// then LayerNorm, without which the dynamics MLP hardly uses touch.
class TouchEmbedding {
 public:
  /// Adds "tactile.dense.weight" [embedding, F], "tactile.dense.bias", "tactile.norm.weight" and
  /// "tactile.norm.bias" [embedding]. F is a multiple of 16.
  static void declare(const ModelSpec& spec, int feature_size, ParameterTable& table);

  /// `features`: [rows, F]. There is a backward pass if `weights` has a gradient.
  TouchEmbedding(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                 const Buffer<float>& features, int rows);

  const Launches& prepare() const { return prepare_; }  ///< once after the weights changed
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  const Buffer<float>& embedding() const { return norm_.y; }               ///< [rows, embedding]
  const Buffer<float>& grad_embedding() const { return grad_embedding_; }  ///< given to backward()
  const Buffer<float>& grad_features() const { return grad_features_; }    ///< [rows, F]

 private:
  void plan_backward(Runtime& runtime, const Weights& weights, const MatrixView& features);

  LayerNormArrays norm_;
  Buffer<float> grad_embedding_, grad_features_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
