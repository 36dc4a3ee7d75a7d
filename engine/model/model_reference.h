#pragma once

#include <vector>

#include "engine/model/model_spec.h"
#include "engine/model/parameters.h"
#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// What a training step sees. Rows in the order [T][S].
struct ModelProblem {
  int sequences, steps;
  std::vector<double> stream;          ///< [frames, rows, cols]
  std::vector<int> last_frame;         ///< [T * S]
  std::vector<double> initial;         ///< [S, state]
  std::vector<double> target, weight;  ///< [T, S, state] and [T, S], the weights' divisor included
  TaxelDropout dropout;
};

struct LossAndGradient {
  double loss;
  std::vector<double> gradient;  ///< flat, as the table lays it out
  /// How far the dynamics MLP and the loss stand from the nearest kink of ReLU, L1 and pinball,
  /// where float may take the other side.
  double kink_distance = 0.0;
};

/// model.h in plain loops: the composition of the operations' references.
LossAndGradient model_reference(const ModelSpec& spec, const ParameterTable& table,
                                const std::vector<double>& parameters, const ModelProblem& problem);

}  // namespace touchtrace
