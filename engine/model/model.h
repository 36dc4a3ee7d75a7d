#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/model/dynamics_mlp.h"
#include "engine/model/tactile_encoder.h"
#include "engine/model/touch_embedding.h"
#include "engine/ops/state_loss.h"

namespace touchtrace {

/// What the device reads of S sequences and T steps; rows in the order [T][S].
struct ModelInput {
  Buffer<std::int32_t> last_frame;  ///< [T * S], of each step's window; unused without touch
  Buffer<float> target, weight;     ///< [T, S, 16] and [T, S], the weights' divisor included
};

/// The whole model on one device, for S sequences and T steps: tactile encoder, embedding, dynamics
/// MLP, and in training loss and gradient. Everything is allocated and built by the constructor;
/// the passes only queue a fixed list of launches.
class Model {
 public:
  enum class Use { prediction, training };

  Model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps, Use use);
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const ModelSpec& spec() const { return spec_; }
  int sequences() const { return sequences_; }
  int steps() const { return steps_; }
  const ParameterTable& table() const { return table_; }
  const Weights& weights() const { return *weights_; }
  const ModelInput& input() const { return input_; }

  /// To be called whenever the weights changed.
  void prepare();
  /// `stream`: [frames, rows, cols], which input().last_frame points into; unused without touch.
  /// The first S rows of states() are the initial states.
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout = {});
  /// The loss of the last forward pass, and its gradient into weights().gradient.
  void backward();

  const Buffer<float>& states() const { return dynamics_->arrays().states; }  ///< [T + 1, S, 16]
  const Buffer<float>& spread() const { return dynamics_->arrays().spread; }  ///< [T, S, 16]
  const Buffer<float>& loss() const { return loss_; }                         ///< [1]

 private:
  void plan_loss();

  Runtime& runtime_;
  ModelSpec spec_;
  int sequences_, steps_;
  ParameterTable table_;
  std::unique_ptr<TactileEncoder> encoder_;
  std::unique_ptr<Weights> weights_;
  std::unique_ptr<TouchEmbedding> touch_;
  std::unique_ptr<DynamicsMlp> dynamics_;
  ModelInput input_;
  Buffer<float> loss_;
  Launches loss_launches_;
};

}  // namespace touchtrace
