#pragma once

#include "engine/model/model_spec.h"
#include "engine/model/weights.h"
#include "engine/ops/rollout.h"

namespace touchtrace {

/// The dynamics MLP rolled out over T steps (equation 1): [state, g_t] -> hidden -> hidden ->
/// [delta, band], the next state is state + delta, the spread is softplus(band).
///
/// The embedding's part of layer 1 does not depend on the state, so it is one GEMM over all rows.
class DynamicsMlp {
 public:
  /// Adds "dynamics.0.weight" [hidden, state + embedding], "dynamics.2.weight" [hidden, hidden],
  /// "dynamics.4.weight" [2 state, hidden] and a bias for each. Without touch there is no
  /// embedding.
  static void declare(const ModelSpec& spec, ParameterTable& table);

  /// `embedding`: [T * S, embedding], rows in the order [step][sequence]; unused without touch.
  DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
              const Buffer<float>& embedding, int sequences, int steps);

  /// Towards `embedding`, if there is one, goes `grad_embedding`.
  void plan_backward(Runtime& runtime, const Buffer<float>& grad_embedding);

  const Launches& prepare() const { return prepare_; }  ///< once after the weights changed
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  const RolloutArrays& arrays() const { return arrays_; }
  /// Of the loss towards states and spread: what the backward pass starts from.
  const RolloutGradients& gradients() const { return gradients_; }

 private:
  void plan_prepare(Runtime& runtime);
  void plan_hoisted(Runtime& runtime);
  void plan_weight_gradients(Runtime& runtime);

  ModelSpec spec_;
  Weights weights_;
  Buffer<float> embedding_;
  MatrixView hoisted_weight_;
  RolloutArrays arrays_;
  RolloutGradients gradients_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
