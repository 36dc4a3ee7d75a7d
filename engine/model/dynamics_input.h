#pragma once

#include <string>

#include "engine/model/dynamics.h"

namespace touchtrace {

/// First layer of the dynamics, from [state, g_t, e_i]. The products with the embeddings do not
/// depend on the state: two GEMMs, over S and over T S rows, compute them before the roll-out,
/// which adds the product with the state at every step.
class DynamicsInput {
 public:
  struct Names {
    std::string weight, bias;
  };

  /// Adds the weight [outputs, state + embedding + embedding] and the bias [outputs]. Inputs that
  /// the spec omits have no columns.
  static void declare(const ModelSpec& spec, const Names& names, int outputs, double half_range,
                      ParameterTable& table);
  /// Columns of the weight.
  static int inputs(const ModelSpec& spec);

  /// `state_row`: distance of the rows of state_weight() in floats.
  DynamicsInput(Runtime& runtime, const ModelSpec& spec, const Weights& weights, const Names& names,
                const Embeddings& embeddings, int sequences, int steps, int state_row);

  /// `grad_output`: [T * S, outputs] gradient with respect to the layer's pre-activations.
  /// `states`: [T * S, 16] before each step.
  void plan_backward(Runtime& runtime, const MatrixView& grad_output, const Buffer<float>& states,
                     const Embeddings& grad);

  const Launches& prepare() const { return prepare_; }
  const Launches& forward() const { return forward_; }
  const Launches& backward() const { return backward_; }

  /// [T * S, outputs] bias and products with the embeddings; row 0: the same row for all.
  const MatrixView& input_projection() const { return input_projection_; }
  /// [state, outputs] columns of the weight for the state, transposed.
  const Buffer<float>& state_weight() const { return state_weight_; }
  /// [outputs, 16] the same columns, zero-padded; only with a weight gradient.
  const Buffer<float>& padded_state_weight() const { return padded_state_weight_; }

 private:
  /// Plans the product of `inputs` [rows, embedding] with the weight's columns from `column` on,
  /// added to row m % start_rows of input_projection_. Returns the sum [rows, outputs].
  MatrixView plan_projection(Runtime& runtime, const Buffer<float>& inputs, int column, int rows,
                             int start_rows);
  /// Plans the weight gradient of an embedding's columns and, unless `grad_inputs` is empty, the
  /// gradient with respect to the embedding.
  void plan_embedding_gradients(Runtime& runtime, const MatrixView& grad_output, int rows,
                                int column, const Buffer<float>& inputs,
                                const Buffer<float>& grad_inputs);

  int touch_column() const { return spec_.state; }
  int object_column() const { return spec_.state + spec_.embedding; }
  bool has_object() const { return spec_.object != ObjectEncoder::none; }

  ModelSpec spec_;
  Weights weights_;
  Names names_;
  Embeddings embeddings_;
  int sequences_, steps_, outputs_;
  MatrixView input_projection_;
  Buffer<float> state_weight_, padded_state_weight_;
  Launches prepare_, forward_, backward_;
};

}  // namespace touchtrace
