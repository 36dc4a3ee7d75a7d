#pragma once

#include <vector>

#include "engine/check/rollout_reference.h"

namespace touchtrace {

/// Weights of the GRU in PyTorch's layout: [outputs, inputs], outputs in the order r, z, n.
struct GruWeights {
  std::vector<double> w;        ///< [3 hidden, state]: state columns of weight_ih
  std::vector<double> u, bias;  ///< [3 hidden, hidden], [3 hidden]: weight_hh and bias_hh
  std::vector<double> w3, b3;   ///< [2 state, hidden], [2 state]
};

/// Roll-out with the values that its gradient needs. Rows are ordered [T][S].
struct GruTrace {
  std::vector<double> states;      ///< [T + 1, S, state]
  std::vector<double> h;           ///< [T + 1, S, hidden]
  std::vector<double> r, z, n, a;  ///< [T, S, hidden]
  std::vector<double> spread;      ///< [T, S, state]
};

struct GruReferenceGradients {
  std::vector<double> input_projection;
  GruWeights weights;
};

/// GRU roll-out in plain loops. `shape.activation` is not used; `initial_h`: [S, hidden]; `first`:
/// [T * S, 3 hidden] or, shared, [3 hidden].
GruTrace gru_rollout_reference(const RolloutShape& shape, const std::vector<double>& initial,
                               const std::vector<double>& initial_h,
                               const std::vector<double>& input_projection,
                               const GruWeights& weights);

/// `grad_state`, `grad_spread`: [T, S, state], with respect to the predicted states and spread.
GruReferenceGradients gru_rollout_backward_reference(const RolloutShape& shape,
                                                     const GruTrace& trace,
                                                     const GruWeights& weights,
                                                     const std::vector<double>& grad_state,
                                                     const std::vector<double>& grad_spread);

}  // namespace touchtrace
