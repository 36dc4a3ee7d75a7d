#pragma once

#include "engine/model/touch_encoder.h"

namespace touchtrace {

/// The object encoder in training, alone, for N segments of touch (section III-C): their
/// embeddings, and the contrastive loss between them. Everything is allocated and built by the
/// constructor.
class ObjectModel {
 public:
  ObjectModel(Runtime& runtime, const ModelSpec& spec, int segments, const Tuning& tuning = {});
  ObjectModel(const ObjectModel&) = delete;
  ObjectModel& operator=(const ObjectModel&) = delete;

  int segments() const { return segments_; }
  const ParameterTable& table() const { return table_; }
  const Weights& weights() const { return weights_; }

  /// [N], for the caller to write: the last frame of each segment in the stream, the object of
  /// each and the weight of its pairs in the loss, as info_nce.h takes them.
  const Buffer<int>& last_frame() const { return encoder_.last_frame(); }
  const Buffer<int>& object() const { return object_; }
  const Buffer<float>& weight() const { return weight_; }

  /// To be called whenever the weights changed.
  void prepare() { encoder_.prepare(); }
  /// `stream`: [frames, rows, cols].
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout) {
    encoder_.forward(stream, dropout);
  }
  /// The loss of the last forward pass, and its gradient into weights().gradient.
  void backward();

  const Buffer<float>& embedding() const { return encoder_.embedding(); }  ///< [N, embedding]
  const Buffer<float>& loss() const { return loss_; }                      ///< [1]

 private:
  void plan_loss(const ModelSpec& spec);

  Runtime& runtime_;
  int segments_;
  ParameterTable table_;
  Weights weights_;
  TouchEncoder encoder_;
  Buffer<int> object_;
  Buffer<float> weight_, loss_;
  Launches loss_launches_;
};

}  // namespace touchtrace
