#pragma once

#include <vector>

#include "engine/ops/activation.h"

namespace touchtrace {

struct RolloutShape {
  int sequences, steps, state, hidden;
  bool shared_input_projection;  ///< one row [hidden] instead of [T * S, hidden]
  Activation activation = Activation::relu;
};

/// Weights of the dynamics MLP in PyTorch's layout: [outputs, inputs].
struct RolloutWeights {
  std::vector<double> w1;      ///< [hidden, state]: state columns of the first layer
  std::vector<double> w2, b2;  ///< [hidden, hidden], [hidden]
  std::vector<double> w3, b3;  ///< [2 state, hidden], [2 state]
};

/// Roll-out with the values that its gradient needs. Rows are ordered [T][S].
struct RolloutTrace {
  std::vector<double> states;                            ///< [T + 1, S, state]
  std::vector<double> pre_activation1, pre_activation2;  ///< [T, S, hidden], pre-activations
  std::vector<double> spread;                            ///< [T, S, state]
};

struct RolloutReferenceGradients {
  std::vector<double> input_projection;
  RolloutWeights weights;
};

/// MLP roll-out in plain loops.
RolloutTrace rollout_reference(const RolloutShape& shape, const std::vector<double>& initial,
                               const std::vector<double>& input_projection,
                               const RolloutWeights& weights);

/// `grad_state`, `grad_spread`: [T, S, state], with respect to the predicted states and spread.
RolloutReferenceGradients rollout_backward_reference(const RolloutShape& shape,
                                                     const RolloutTrace& trace,
                                                     const RolloutWeights& weights,
                                                     const std::vector<double>& grad_state,
                                                     const std::vector<double>& grad_spread);

}  // namespace touchtrace
