#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "engine/model/dynamics.h"
#include "engine/model/tactile_encoder.h"

namespace touchtrace {

/// Device inputs for S sequences of T steps, written by the caller; unused ones are empty.
struct ModelInput {
  Buffer<std::int32_t> window_end;  ///< [T, S] last stream frame of each window
  Buffer<float> tactile_embedding;  ///< [T, S, embedding] g_t, instead of windows (Use::rollout)
  Buffer<float> object_embedding;   ///< [S, embedding] e_i, unless the model trains its encoder
  // Training:
  Buffer<float> target;  ///< [T, S, 16] scaled states, zero-padded
  Buffer<float> weight;  ///< [T, S] loss weights, summing to 1 / state size
  // Training with ObjectEncoder::joint, [S]:
  Buffer<std::int32_t> segment_end, object;  ///< last stream frame; object index
  Buffer<float> contrast_weight;             ///< of each positive pair (info_nce.h)
};

/// Encoders, dynamics and, in training, loss and gradient, for S sequences of T steps. Passes
/// enqueue and do not wait. Not thread-safe; the Runtime must outlive it. The constructor allocates
/// all buffers; it throws usage_error for an invalid spec, device_error if memory is short.
///
/// The model contains an object encoder only for ObjectEncoder::joint and Use::training. Otherwise
/// e_i is an input, computed by object_embedder.h.
class Model {
 public:
  enum class Use {
    prediction,  ///< no gradient
    rollout,     ///< no gradient and no tactile encoder: g_t is an input
    training
  };

  /// `live`: live taxels of the stream.
  Model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps, Use use,
        const LiveTaxels& live = {});
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const ModelSpec& spec() const { return spec_; }
  int sequences() const { return sequences_; }
  int steps() const { return steps_; }
  const ParameterTable& table() const { return table_; }
  const Weights& weights() const { return *weights_; }
  const ModelInput& input() const { return input_; }

  /// Call after every change of the weights.
  void prepare();
  /// `stream`: [frames, rows, cols], indexed by input().window_end; unused without touch. The
  /// caller writes the initial states to the first S rows of states(). `segment_dropout`: of the
  /// object encoder.
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout = {},
               const TaxelDropout& segment_dropout = {});
  /// Zeroes the hidden state of a recurrent dynamics. Call before a new roll-out.
  void reset_state() { dynamics_->reset_state(runtime_); }
  /// Carries it into the next forward(), for roll-outs longer than T. The caller copies the last S
  /// rows of states() to the first S.
  void carry_state() { enqueue(runtime_, dynamics_->carry_state()); }
  /// Computes loss() of the last forward pass, L_state plus the weighted contrastive loss if the
  /// object encoder is trained jointly, and overwrites weights().gradient.
  void backward();

  const Buffer<float>& states() const { return dynamics_->states(); }  ///< [T + 1, S, 16]
  const Buffer<float>& spread() const { return dynamics_->spread(); }  ///< [T, S, 16]
  /// One buffer that starts with states() and ends with spread(), to read both at once.
  const Buffer<float>& states_and_spread() const { return dynamics_->states_and_spread(); }
  const Buffer<float>& loss() const { return loss_; }  ///< [1]

 private:
  void plan_tactile_encoder(const LiveTaxels& live);
  void plan_object_encoder(const LiveTaxels& live);
  void plan_loss();
  Embeddings embeddings() const;
  /// Enqueues the object encoder's launches, if it exists, on the second queue, concurrent with
  /// `others`.
  void enqueue_concurrently(const std::function<void()>& object,
                            const std::function<void()>& others);

  Runtime& runtime_;
  ModelSpec spec_;
  int sequences_, steps_;
  ParameterTable table_;
  std::unique_ptr<TactileEncoder> tactile_, object_;
  std::unique_ptr<Weights> weights_;
  std::unique_ptr<Dynamics> dynamics_;
  ModelInput input_;
  Buffer<float> loss_;
  Launches state_loss_;  ///< before the dynamics' backward pass
  Launches total_loss_;  ///< after it
};

}  // namespace touchtrace
