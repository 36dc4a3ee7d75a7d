#pragma once

#include <functional>
#include <vector>

#include "engine/model/model_spec.h"
#include "tests/verify/engine/encoder_reference.h"

namespace touchtrace {

/// What the dynamics is rolled out from. Rows in the order [T][S].
struct DynamicsProblem {
  int sequences, steps;
  std::vector<double> initial;     ///< [S, state]
  std::vector<double> embeddings;  ///< [T * S, columns]: what it sees beside the state
  int columns;                     ///< perhaps 0
};

/// dynamics.h in plain loops: a roll-out, and the way back.
struct DynamicsReference {
  std::vector<double> states;  ///< [T + 1, S, state]
  std::vector<double> spread;  ///< [T, S, state]
  double kink_distance;        ///< of the nearest sum from a kink of the activation
  /// Sets the gradients of the dynamics' parameters from those towards the predicted states and the
  /// spread, and returns that towards the embeddings.
  std::function<std::vector<double>(const std::vector<double>& grad_state,
                                    const std::vector<double>& grad_spread, FlatParameters&)>
      backward;
};

DynamicsReference dynamics_reference(const ModelSpec& spec, const FlatParameters& parameters,
                                     const DynamicsProblem& problem);

}  // namespace touchtrace
