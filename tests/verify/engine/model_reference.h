#pragma once

#include <vector>

#include "engine/model/model_spec.h"
#include "engine/model/parameters.h"
#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// Inputs of a training step. Rows in the order [T, S].
struct ModelProblem {
  int sequences, steps;
  std::vector<double> stream;          ///< [frames, rows, cols]
  std::vector<int> window_end;         ///< [T * S]
  std::vector<double> initial;         ///< [S, state]
  std::vector<double> target, weight;  ///< [T, S, state] and [T, S] (ModelInput)
  TaxelDropout dropout;
  // With a jointly trained object encoder, [S] (ModelInput):
  std::vector<int> segment_end, object;
  std::vector<double> contrast_weight;
  TaxelDropout segment_dropout;
};

struct LossAndGradient {
  double loss;
  std::vector<double> gradient;  ///< flat, laid out by the table
  /// Distance from the nearest kink of ReLU, L1 and pinball; near one, float may be on the other
  /// side.
  double kink_distance = 0.0;
};

/// Reference of model.h in plain loops, composed of the references of the operations. Does not
/// support frozen embeddings.
LossAndGradient model_reference(const ModelSpec& spec, const ParameterTable& table,
                                const std::vector<double>& parameters, const ModelProblem& problem);

}  // namespace touchtrace
