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
  // With an object encoder trained along, all [S], as in model.h.
  std::vector<int> segment_last_frame, object;
  std::vector<double> contrast_weight;
  TaxelDropout segment_dropout;
};

struct LossAndGradient {
  double loss;
  std::vector<double> gradient;  ///< flat, as the table lays it out
  /// How far the dynamics and the loss stand from the nearest kink of ReLU, L1 and pinball,
  /// where float may take the other side.
  double kink_distance = 0.0;
};

/// model.h in plain loops: the composition of the operations' references. Frozen embeddings are not
/// covered.
LossAndGradient model_reference(const ModelSpec& spec, const ParameterTable& table,
                                const std::vector<double>& parameters, const ModelProblem& problem);

}  // namespace touchtrace
