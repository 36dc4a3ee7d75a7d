#include "engine/model/dynamics_input.h"

namespace touchtrace {

int DynamicsInput::inputs(const ModelSpec& spec) {
  const int embeddings = (spec.touch ? 1 : 0) + (spec.object != ObjectEncoder::none ? 1 : 0);
  return spec.state + embeddings * spec.embedding;
}

void DynamicsInput::declare(const ModelSpec& spec, const Names& names, int outputs,
                            double half_range, ParameterTable& table) {
  table.add(names.weight, {outputs, inputs(spec)}, {0.0, half_range});
  table.add(names.bias, {outputs}, {0.0, half_range});
}

DynamicsInput::DynamicsInput(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                             const Names& names, const Embeddings& embeddings, int sequences,
                             int steps, int state_row)
    : spec_(spec),
      weights_(weights),
      names_(names),
      embeddings_(embeddings),
      sequences_(sequences),
      steps_(steps),
      outputs_(weights.table.at(names.bias).shape.front()),
      input_projection_(weights.value(names.bias)),
      state_weight_(runtime.allocate<float>(std::size_t(spec.state) * state_row)) {
  prepare_.push_back(pack(runtime, weights.value(names.weight).transposed(),
                          {state_weight_, 0, state_row}, spec.state, outputs_, outputs_));
  if (weights.gradient.size() > 0) {
    padded_state_weight_ = runtime.allocate<float>(std::size_t(outputs_) * state_lanes);
    prepare_.push_back(pack(runtime, weights.value(names.weight),
                            {padded_state_weight_, 0, state_lanes}, outputs_, spec.state,
                            state_lanes));
  }
  if (has_object())
    input_projection_ = plan_projection(runtime, embeddings.object, object_column(), sequences, 1);
  if (spec.touch)
    input_projection_ = plan_projection(runtime, embeddings.touch, touch_column(),
                                        sequences * steps, has_object() ? sequences : 1);
}

MatrixView DynamicsInput::plan_projection(Runtime& runtime, const Buffer<float>& inputs, int column,
                                          int rows, int start_rows) {
  const int size = spec_.embedding;
  const MatrixView by_input{runtime.allocate<float>(std::size_t(size) * outputs_), 0, outputs_};
  const auto weight = weights_.value(names_.weight).from_column(column);
  prepare_.push_back(pack(runtime, weight.transposed(), by_input, size, outputs_, outputs_));
  const MatrixView sums{runtime.allocate<float>(std::size_t(rows) * outputs_), 0, outputs_};
  append(forward_, gemm(runtime, {inputs, 0, size}, by_input, input_projection_, sums, rows,
                        outputs_, size, start_rows));
  return sums;
}

void DynamicsInput::plan_backward(Runtime& runtime, const MatrixView& grad_output,
                                  const Buffer<float>& states, const Embeddings& grad) {
  const int rows = sequences_ * steps_, state = spec_.state;
  backward_ = gemm(runtime, grad_output.transposed(), {states, 0, state_lanes}, {},
                   weights_.grad(names_.weight), outputs_, state, rows);
  backward_.push_back(
      column_sums(runtime, grad_output, weights_.grad(names_.bias), rows, outputs_));
  if (spec_.touch)
    plan_embedding_gradients(runtime, grad_output, rows, touch_column(), embeddings_.touch,
                             grad.touch);
  if (!has_object()) return;
  // One row per sequence: sums over the steps, whose rows are adjacent.
  const int row = sequences_ * grad_output.row;
  const MatrixView sums{runtime.allocate<float>(std::size_t(row)), 0, grad_output.row};
  backward_.push_back(
      column_sums(runtime, {grad_output.buffer, grad_output.at, row}, sums, steps_, row));
  plan_embedding_gradients(runtime, sums, sequences_, object_column(), embeddings_.object,
                           grad.object);
}

void DynamicsInput::plan_embedding_gradients(Runtime& runtime, const MatrixView& grad_output,
                                             int rows, int column, const Buffer<float>& inputs,
                                             const Buffer<float>& grad_inputs) {
  const int size = spec_.embedding;
  append(backward_, gemm(runtime, grad_output.transposed(), {inputs, 0, size}, {},
                         weights_.grad(names_.weight).from_column(column), outputs_, size, rows));
  if (grad_inputs.size() > 0)
    append(backward_, with_purpose(gemm(runtime, grad_output,
                                        weights_.value(names_.weight).from_column(column), {},
                                        {grad_inputs, 0, size}, rows, size, outputs_),
                                   Purpose::data_gradient));
}

}  // namespace touchtrace
