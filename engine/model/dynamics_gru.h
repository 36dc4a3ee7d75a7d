#pragma once

#include "engine/model/dynamics_input.h"
#include "engine/model/dynamics_output.h"
#include "engine/ops/gru_rollout.h"

namespace touchtrace {

/// GRU instead of the MLP. The hidden state h starts at zero and lasts for a roll-out.
///
///   h' = GRU(h, [state, g_t, e_i]),  [delta, band] = W h' + b
///
/// Equations and parameters are those of PyTorch's GRUCell and Linear.
class DynamicsGru : public Dynamics {
 public:
  /// Adds "dynamics.cell.weight_ih" [3 hidden, state + embedding + embedding],
  /// "dynamics.cell.weight_hh" [3 hidden, hidden], "dynamics.cell.bias_ih" and
  /// "dynamics.cell.bias_hh" [3 hidden], each in the order reset, update, new gate;
  /// "dynamics.out.weight" [2 state, hidden] and "dynamics.out.bias".
  static void declare(const ModelSpec& spec, ParameterTable& table);

  DynamicsGru(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
              const Embeddings& embeddings, int sequences, int steps);

  void plan_backward(Runtime& runtime, const Embeddings& grad) override;
  void reset_state(Runtime& runtime) const override { runtime.fill(arrays_.h, 0.0f); }

 private:
  /// Gradients of weight_hh and bias_hh from `d_gates` (layout: gru_rollout.h).
  void plan_hidden_gradients(Runtime& runtime, const MatrixView& d_gates);

  Weights weights_;
  DynamicsInput input_;
  DynamicsOutput output_;
  GruArrays arrays_;
};

}  // namespace touchtrace
