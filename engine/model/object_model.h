#pragma once

#include "engine/model/tactile_encoder.h"

namespace touchtrace {

/// Object encoder for training alone, on N segments (section III-C): embeddings, contrastive loss
/// and gradient. The constructor allocates all buffers; it throws usage_error for an invalid spec.
class ObjectModel {
 public:
  ObjectModel(Runtime& runtime, const ModelSpec& spec, int segments);
  ObjectModel(const ObjectModel&) = delete;
  ObjectModel& operator=(const ObjectModel&) = delete;

  int segments() const { return segments_; }
  const ParameterTable& table() const { return table_; }
  const Weights& weights() const { return weights_; }

  // Inputs written by the caller, [N]:
  const Buffer<int>& window_end() const { return encoder_.window_end(); }  ///< last stream frame
  const Buffer<int>& object() const { return object_; }                    ///< object index
  const Buffer<float>& weight() const { return weight_; }  ///< of each positive pair (info_nce.h)

  /// Call after every change of the weights.
  void prepare() { encoder_.prepare(); }
  /// `stream`: [frames, rows, cols].
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
    encoder_.forward(stream, dropout);
  }
  /// Computes loss() of the last forward pass and overwrites weights().gradient.
  void backward();

  const Buffer<float>& loss() const { return loss_; }  ///< [1]

 private:
  void plan_loss(const ModelSpec& spec);

  Runtime& runtime_;
  int segments_;
  ParameterTable table_;
  Weights weights_;
  TactileEncoder encoder_;
  Buffer<int> object_;
  Buffer<float> weight_, loss_;
  Launches loss_launches_;
};

}  // namespace touchtrace
