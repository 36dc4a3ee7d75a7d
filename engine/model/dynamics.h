#pragma once

#include <memory>

#include "engine/model/model_spec.h"
#include "engine/model/weights.h"
#include "engine/ops/rollout.h"

namespace touchtrace {

/// Embeddings on the device, or the gradients towards them. Those that a spec leaves out are
/// unused.
struct Embeddings {
  Buffer<float> touch;   ///< g_t: [T * S, embedding], rows in the order [step][sequence]
  Buffer<float> object;  ///< e_i: [S, embedding], constant over the steps
};

/// The dynamics rolled out over T steps (equation 1): from [state, g_t, e_i] a change of the state
/// and a spread, the distance to the quantiles. Everything is planned by the constructor and
/// plan_backward(); the launches are then queued by the caller.
class Dynamics {
 public:
  virtual ~Dynamics() = default;

  /// Gradients are computed towards the embeddings whose buffer in `grad` is not empty.
  virtual void plan_backward(Runtime& runtime, const Embeddings& grad) = 0;

  const Launches& prepare() const { return prepare_; }  ///< once after the weights changed
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }
  /// Between forward passes over T steps each of longer roll-outs: hands on what the dynamics
  /// remembers beside the state. The states are for the caller to hand on.
  const Launches& go_on() const { return go_on_; }
  /// Forgets it. Roll-outs begin so; a new object remembers nothing.
  virtual void forget(Runtime&) const {}

  const Buffer<float>& states() const { return states_; }  ///< [T + 1, S, 16], the first S given
  const Buffer<float>& spread() const { return spread_; }  ///< [T, S, 16]
  /// Begins with states() and ends with spread().
  const Buffer<float>& outcome() const { return outcome_; }
  /// Of the loss towards states and spread: what the backward pass starts from. [T, S, 16]
  const Buffer<float>& grad_state() const { return grad_state_; }
  const Buffer<float>& grad_spread() const { return grad_spread_; }

 protected:
  Dynamics(Runtime& runtime, int sequences, int steps);
  void allocate_gradients(Runtime& runtime);

  Launches prepare_, forward_, backward_, go_on_;
  Buffer<float> outcome_, states_, spread_, grad_state_, grad_spread_;
};

/// Adds the parameters of the dynamics that `spec` names (dynamics_mlp.h, dynamics_gru.h).
void declare_dynamics(const ModelSpec& spec, ParameterTable& table);
std::unique_ptr<Dynamics> make_dynamics(Runtime& runtime, const ModelSpec& spec,
                                        const Weights& weights, const Embeddings& embeddings,
                                        int sequences, int steps);

}  // namespace touchtrace
