#pragma once

#include <functional>
#include <vector>

#include "engine/model/model_spec.h"
#include "tests/verify/engine/encoder_reference.h"

namespace touchtrace {

/// Inputs of a roll-out. Rows in the order [T, S].
struct DynamicsProblem {
  int sequences, steps;
  std::vector<double> initial;     ///< [S, state]
  std::vector<double> embeddings;  ///< [T * S, columns] inputs in addition to the state
  int columns;                     ///< may be 0
};

/// Reference of dynamics.h in plain loops: a roll-out and its backward pass.
struct DynamicsReference {
  std::vector<double> states;  ///< [T + 1, S, state]
  std::vector<double> spread;  ///< [T, S, state]
  double kink_distance;  ///< smallest distance of a pre-activation from a kink of the activation
  /// Sets the gradients of the dynamics' parameters from those with respect to the predicted states
  /// and the spread. Returns the gradient with respect to the embeddings.
  std::function<std::vector<double>(const std::vector<double>& grad_state,
                                    const std::vector<double>& grad_spread, FlatParameters&)>
      backward;
};

/// Columns [begin, end) of a matrix with `columns` columns.
std::vector<double> columns_between(const std::vector<double>& matrix, int columns, int begin,
                                    int end);

DynamicsReference dynamics_reference(const ModelSpec& spec, const FlatParameters& parameters,
                                     const DynamicsProblem& problem);

}  // namespace touchtrace
