#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "engine/model/dynamics.h"
#include "engine/model/touch_encoder.h"

namespace touchtrace {

/// What the device reads of S sequences and T steps; rows in the order [T][S]. Without touch there
/// is nothing but targets, without an object encoder nothing below them.
struct ModelInput {
  Buffer<std::int32_t> last_frame;  ///< [T * S], of each step's window
  Buffer<float> target, weight;     ///< [T, S, 16] and [T, S], the weights' divisor included

  Buffer<float> tactile_embedding;  ///< [T * S, embedding]: g_t, instead of windows (Use::rollout)
  /// [S, embedding]: e_i of each sequence, unless the object encoder is trained along.
  Buffer<float> object_embedding;
  // Where it is: the last frame of each sequence's segment, the object in hand, and how much each
  // pair of a sequence with another one of its object weighs in the contrastive loss. All [S].
  Buffer<std::int32_t> segment_last_frame, object;
  Buffer<float> contrast_weight;
};

/// The whole model on one device, for S sequences and T steps: encoders, dynamics, and in
/// training loss and gradient. Everything is allocated and built by the constructor; the passes
/// only queue a fixed list of launches.
///
/// An object encoder is part of the model only where it is trained along (ObjectEncoder::joint and
/// Use::training); else e_i is an input, which object_encoder.h makes.
class Model {
 public:
  /// `prediction` needs no gradient; `rollout` neither that nor the tactile encoder, since each g_t
  /// is given.
  enum class Use { prediction, rollout, training };

  /// `live`: of the stream. `tuning`: counts in training alone.
  Model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps, Use use,
        const LiveTaxels& live = {}, const Tuning& tuning = {});
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
  /// `segment_dropout`: of the windows that the object is known from.
  void forward(const Buffer<float>& stream, const TaxelDropout& dropout = {},
               const TaxelDropout& segment_dropout = {});
  /// forward() in two halves, for prediction with touch of one sequence and one step, as in
  /// tactile_encoder.h.
  void forward_early(const Buffer<float>& stream) { tactile_->forward_early(stream); }
  void forward_late(const Buffer<float>& stream);
  /// Before the first of several forward passes over T steps each of longer roll-outs, and between
  /// them: forgets or hands on what the dynamics remembers beside the states.
  void begin_rollouts() { dynamics_->forget(runtime_); }
  void continue_rollouts() { enqueue(runtime_, dynamics_->go_on()); }
  /// The loss of the last forward pass, L_state plus the weighted contrastive loss where the object
  /// encoder is trained along, and its gradient into weights().gradient.
  void backward();

  const Buffer<float>& states() const { return dynamics_->states(); }  ///< [T + 1, S, 16]
  const Buffer<float>& spread() const { return dynamics_->spread(); }  ///< [T, S, 16]
  /// Begins with states() and ends with spread(), so that both may be read at once.
  const Buffer<float>& outcome() const { return dynamics_->outcome(); }
  const Buffer<float>& loss() const { return loss_; }  ///< [1]

 private:
  void plan_tactile_encoder(const LiveTaxels& live, const Tuning& tuning);
  void plan_object_encoder(const LiveTaxels& live, const Tuning& tuning);
  void plan_loss();
  Embeddings embeddings() const;
  /// Queues what the object encoder does, if there is one, so that it runs beside the others.
  void beside_object_encoder(const std::function<void()>& object,
                             const std::function<void()>& others);

  Runtime& runtime_;
  ModelSpec spec_;
  int sequences_, steps_;
  ParameterTable table_;
  std::unique_ptr<TouchEncoder> tactile_, object_;
  std::unique_ptr<Weights> weights_;
  std::unique_ptr<Dynamics> dynamics_;
  ModelInput input_;
  Buffer<float> loss_;
  Launches state_loss_, total_loss_;  ///< before and after the dynamics' backward pass
};

}  // namespace touchtrace
