#pragma once

#include <memory>

#include "engine/model/model_spec.h"
#include "engine/model/weights.h"
#include "engine/ops/rollout.h"

namespace touchtrace {

/// Embeddings on the device, or gradients with respect to them. Those that the spec omits are
/// empty.
struct Embeddings {
  Buffer<float> touch;   ///< [T, S, embedding] g_t
  Buffer<float> object;  ///< [S, embedding] e_i, constant over the steps
};

/// State transition model rolled out over T steps (equation 1): maps [state, g_t, e_i] to a change
/// of the state and a spread, the distance to the quantiles. The constructor and plan_backward()
/// allocate and build the launches; the caller enqueues them.
class Dynamics {
 public:
  virtual ~Dynamics() = default;

  /// `grad`: receives the gradients with respect to the embeddings; empty buffers are skipped.
  virtual void plan_backward(Runtime& runtime, const Embeddings& grad) = 0;

  const Launches& prepare() const { return prepare_; }  ///< after every change of the weights
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }
  /// Carries the hidden state, if any, into the next forward(), for roll-outs longer than T. The
  /// caller carries states().
  const Launches& carry_state() const { return carry_state_; }
  /// Zeroes the hidden state, if any. Call before a new roll-out.
  virtual void reset_state(Runtime&) const {}

  const Buffer<float>& states() const { return states_; }  ///< [T + 1, S, 16]; first S rows: input
  const Buffer<float>& spread() const { return spread_; }  ///< [T, S, 16]
  /// One buffer that starts with states() and ends with spread().
  const Buffer<float>& states_and_spread() const { return states_and_spread_; }
  /// [T, S, 16] gradients of the loss with respect to states and spread; read by backward().
  const Buffer<float>& grad_state() const { return grad_state_; }
  const Buffer<float>& grad_spread() const { return grad_spread_; }

 protected:
  Dynamics(Runtime& runtime, int sequences, int steps);
  void allocate_gradients(Runtime& runtime);

  Launches prepare_, forward_, backward_, carry_state_;
  Buffer<float> states_and_spread_, states_, spread_, grad_state_, grad_spread_;
};

/// Adds the parameters of the spec's dynamics (dynamics_mlp.h, dynamics_gru.h).
void declare_dynamics(const ModelSpec& spec, ParameterTable& table);
std::unique_ptr<Dynamics> make_dynamics(Runtime& runtime, const ModelSpec& spec,
                                        const Weights& weights, const Embeddings& embeddings,
                                        int sequences, int steps);

}  // namespace touchtrace
