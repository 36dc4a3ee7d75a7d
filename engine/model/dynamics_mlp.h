#pragma once

#include "engine/model/model_spec.h"
#include "engine/model/weights.h"
#include "engine/ops/rollout.h"

namespace touchtrace {

/// Embeddings on the device, or the gradients towards them. Those that a spec leaves out are
/// unused.
struct Embeddings {
  Buffer<float> touch;   ///< g_t: [T * S, embedding], rows in the order [step][sequence]
  Buffer<float> object;  ///< e_i: [S, embedding], constant over the steps
};

/// The dynamics MLP rolled out over T steps (equation 1): [state, g_t, e_i] -> hidden -> hidden ->
/// [delta, band], the next state is state + delta, the spread is softplus(band).
///
/// The embeddings' parts of layer 1 do not depend on the state, so they are one GEMM over S and one
/// over all rows.
class DynamicsMlp {
 public:
  /// Adds "dynamics.0.weight" [hidden, state + embedding + embedding], "dynamics.2.weight" [hidden,
  /// hidden], "dynamics.4.weight" [2 state, hidden] and a bias for each. What the spec leaves out
  /// has no columns.
  static void declare(const ModelSpec& spec, ParameterTable& table);

  DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
              const Embeddings& embeddings, int sequences, int steps);

  /// Gradients are computed towards the embeddings whose buffer in `grad` is not empty.
  void plan_backward(Runtime& runtime, const Embeddings& grad);

  const Launches& prepare() const { return prepare_; }  ///< once after the weights changed
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  const RolloutArrays& arrays() const { return arrays_; }
  /// Of the loss towards states and spread: what the backward pass starts from.
  const RolloutGradients& gradients() const { return gradients_; }

 private:
  void plan_prepare(Runtime& runtime);
  /// [rows, hidden]: what `inputs` [rows, embedding] give to layer 1 from column `column` of its
  /// weight on, added to row m % start_rows of `start`.
  MatrixView plan_hoisted(Runtime& runtime, const Buffer<float>& inputs, int column,
                          const MatrixView& start, int rows, int start_rows);
  void plan_weight_gradients(Runtime& runtime);
  /// The part that an embedding has in layer 1, from the gradient towards that layer's sums.
  void plan_embedding_gradients(Runtime& runtime, const MatrixView& grad_sums, int rows, int column,
                                const Buffer<float>& inputs, const Buffer<float>& grad_inputs);

  int touch_column() const { return spec_.state; }
  int object_column() const { return spec_.state + spec_.embedding; }
  bool has_object() const { return spec_.object != ObjectEncoder::none; }

  ModelSpec spec_;
  Weights weights_;
  Embeddings embeddings_;
  RolloutArrays arrays_;
  RolloutGradients gradients_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
