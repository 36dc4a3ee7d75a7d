#pragma once

#include <string>

#include "engine/model/dynamics.h"

namespace touchtrace {

/// The layer of the dynamics that takes [state, g_t, e_i]. The embeddings' parts of its sums do not
/// depend on the state, so they are one GEMM over S and one over all rows, ahead of the loop over
/// the steps, which adds the state's part.
class DynamicsInput {
 public:
  struct Names {
    std::string weight, bias;
  };

  /// Adds the weight [outputs, state + embedding + embedding] and the bias [outputs]. What the spec
  /// leaves out has no columns.
  static void declare(const ModelSpec& spec, const Names& names, int outputs, double half_range,
                      ParameterTable& table);
  static int inputs(const ModelSpec& spec);

  /// `state_row`: how far apart the rows of state_part() are to be.
  DynamicsInput(Runtime& runtime, const ModelSpec& spec, const Weights& weights, const Names& names,
                const Embeddings& embeddings, int sequences, int steps, int state_row);

  /// `grad_sums`: [T * S, outputs], towards all sums; `states`: [T * S, 16], before each step.
  void plan_backward(Runtime& runtime, const MatrixView& grad_sums, const Buffer<float>& states,
                     const Embeddings& grad);

  const Launches& prepare() const { return prepare_; }
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  /// [T * S, outputs], without the state's part; row 0: one row for all.
  const MatrixView& sums() const { return sums_; }
  const Buffer<float>& state_part() const { return state_part_; }  ///< transposed: [state, outputs]
  /// [outputs, 16], padded; only where the weights have a gradient.
  const Buffer<float>& padded_state_part() const { return padded_state_part_; }

 private:
  /// [rows, outputs]: what `inputs` [rows, embedding] give from column `column` of the weight on,
  /// added to row m % start_rows of the sums so far.
  MatrixView plan_hoisted(Runtime& runtime, const Buffer<float>& inputs, int column, int rows,
                          int start_rows);
  /// The part that an embedding has, from the gradient towards the sums.
  void plan_embedding_gradients(Runtime& runtime, const MatrixView& grad_sums, int rows, int column,
                                const Buffer<float>& inputs, const Buffer<float>& grad_inputs);

  int touch_column() const { return spec_.state; }
  int object_column() const { return spec_.state + spec_.embedding; }
  bool has_object() const { return spec_.object != ObjectEncoder::none; }

  ModelSpec spec_;
  Weights weights_;
  Names names_;
  Embeddings embeddings_;
  int sequences_, steps_, outputs_;
  MatrixView sums_;
  Buffer<float> state_part_, padded_state_part_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
