#pragma once

#include "engine/model/dynamics_input.h"
#include "engine/model/dynamics_output.h"

namespace touchtrace {

/// MLP of the paper: [state, g_t, e_i] -> hidden -> hidden -> [delta, band]. The next state is
/// state + delta, the spread is softplus(band).
class DynamicsMlp : public Dynamics {
 public:
  /// Adds "dynamics.0.weight" [hidden, state + embedding + embedding], "dynamics.2.weight" [hidden,
  /// hidden], "dynamics.4.weight" [2 state, hidden] and their biases.
  static void declare(const ModelSpec& spec, ParameterTable& table);

  DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
              const Embeddings& embeddings, int sequences, int steps);

  void plan_backward(Runtime& runtime, const Embeddings& grad) override;

 private:
  Weights weights_;
  DynamicsInput input_;
  DynamicsOutput output_;
  RolloutArrays arrays_;
};

}  // namespace touchtrace
