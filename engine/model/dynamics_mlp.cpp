#include "engine/model/dynamics_mlp.h"

#include <cmath>

namespace touchtrace {
namespace {

void add_layer(ParameterTable& table, const std::string& name, int outputs, int inputs) {
  const Initial initial{0.0, 1.0 / std::sqrt(inputs)};
  table.add(name + ".weight", {outputs, inputs}, initial);
  table.add(name + ".bias", {outputs}, initial);
}

RolloutArrays allocate(Runtime& runtime, const ModelSpec& spec, int sequences, int steps) {
  const auto rows = std::size_t(sequences) * steps, hidden = std::size_t(spec.hidden);
  RolloutArrays arrays{};
  arrays.sequences = sequences, arrays.steps = steps;
  arrays.state = spec.state, arrays.hidden = spec.hidden;
  arrays.activation = spec.activation;
  arrays.w1 = runtime.allocate<float>(spec.state * hidden);
  arrays.w2 = runtime.allocate<float>(hidden * hidden);
  arrays.w3 = runtime.allocate<float>(hidden * 2 * state_lanes);
  arrays.b3 = runtime.allocate<float>(2 * state_lanes);
  arrays.states = runtime.allocate<float>((rows + sequences) * state_lanes);
  arrays.h1 = runtime.allocate<float>(rows * hidden);
  arrays.h2 = runtime.allocate<float>(rows * hidden);
  if (slope_from_sum(spec.activation))
    for (auto* sums : {&arrays.sum1, &arrays.sum2}) *sums = runtime.allocate<float>(rows * hidden);
  arrays.spread = runtime.allocate<float>(rows * state_lanes);
  return arrays;
}

}  // namespace

void DynamicsMlp::declare(const ModelSpec& spec, ParameterTable& table) {
  const int embeddings = (spec.touch ? 1 : 0) + (spec.object != ObjectEncoder::none ? 1 : 0);
  add_layer(table, "dynamics.0", spec.hidden, spec.state + embeddings * spec.embedding);
  add_layer(table, "dynamics.2", spec.hidden, spec.hidden);
  add_layer(table, "dynamics.4", 2 * spec.state, spec.hidden);
}

DynamicsMlp::DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                         const Embeddings& embeddings, int sequences, int steps)
    : spec_(spec),
      weights_(weights),
      embeddings_(embeddings),
      arrays_(allocate(runtime, spec, sequences, steps)) {
  arrays_.parameters = weights.values;
  arrays_.b2_at = weights.value("dynamics.2.bias").at;
  arrays_.w2_at = weights.value("dynamics.2.weight").at;
  arrays_.w3_at = weights.value("dynamics.4.weight").at;
  arrays_.first = weights.value("dynamics.0.bias");
  plan_prepare(runtime);
  if (has_object())
    arrays_.first =
        plan_hoisted(runtime, embeddings.object, object_column(), arrays_.first, sequences, 1);
  if (spec.touch)
    arrays_.first = plan_hoisted(runtime, embeddings.touch, touch_column(), arrays_.first,
                                 sequences * steps, has_object() ? sequences : 1);
  forward_.push_back(rollout(runtime, arrays_));
}

void DynamicsMlp::plan_prepare(Runtime& runtime) {
  const int state = spec_.state, hidden = spec_.hidden;
  const auto w1 = weights_.value("dynamics.0.weight"), w2 = weights_.value("dynamics.2.weight"),
             w3 = weights_.value("dynamics.4.weight"), b3 = weights_.value("dynamics.4.bias");
  prepare_ = {pack(runtime, w1.transposed(), {arrays_.w1, 0, hidden}, state, hidden, hidden),
              pack(runtime, w2.transposed(), {arrays_.w2, 0, hidden}, hidden, hidden, hidden)};
  for (int part = 0; part < 2; ++part) {  // delta, band
    const int to = part * state_lanes;
    prepare_.push_back(pack(runtime, w3.from_row(part * state).transposed(),
                            {arrays_.w3, to, 2 * state_lanes}, hidden, state, state_lanes));
    prepare_.push_back(
        pack(runtime, b3.from_column(part * state), {arrays_.b3, to}, 1, state, state_lanes));
  }
}

MatrixView DynamicsMlp::plan_hoisted(Runtime& runtime, const Buffer<float>& inputs, int column,
                                     const MatrixView& start, int rows, int start_rows) {
  const int hidden = spec_.hidden, size = spec_.embedding;
  const MatrixView by_input{runtime.allocate<float>(std::size_t(size) * hidden), 0, hidden};
  const auto weight = weights_.value("dynamics.0.weight").from_column(column);
  prepare_.push_back(pack(runtime, weight.transposed(), by_input, size, hidden, hidden));
  const MatrixView sums{runtime.allocate<float>(std::size_t(rows) * hidden), 0, hidden};
  forward_.push_back(
      gemm(runtime, {inputs, 0, size}, by_input, start, sums, rows, hidden, size, start_rows));
  return sums;
}

void DynamicsMlp::plan_backward(Runtime& runtime, const Embeddings& grad) {
  const auto rows = std::size_t(arrays_.sequences) * arrays_.steps;
  const int state = spec_.state, hidden = spec_.hidden;
  gradients_ = {.grad_state = runtime.allocate<float>(rows * state_lanes),
                .grad_spread = runtime.allocate<float>(rows * state_lanes),
                .w1 = runtime.allocate<float>(std::size_t(hidden) * state_lanes),
                .d_out = runtime.allocate<float>(rows * 2 * state_lanes),
                .d_h1 = runtime.allocate<float>(rows * hidden),
                .d_h2 = runtime.allocate<float>(rows * hidden)};
  const auto w1 = weights_.value("dynamics.0.weight");
  prepare_.push_back(
      pack(runtime, w1, {gradients_.w1, 0, state_lanes}, hidden, state, state_lanes));
  backward_ = {rollout_backward(runtime, arrays_, gradients_)};
  plan_weight_gradients(runtime);
  if (spec_.touch)
    plan_embedding_gradients(runtime, {gradients_.d_h1, 0, hidden}, int(rows), touch_column(),
                             embeddings_.touch, grad.touch);
  if (!has_object()) return;
  // One row a sequence: the sum over the steps, whose rows lie side by side.
  const MatrixView sums{runtime.allocate<float>(std::size_t(arrays_.sequences) * hidden), 0,
                        hidden};
  const int row = arrays_.sequences * hidden;
  backward_.push_back(column_sums(runtime, {gradients_.d_h1, 0, row}, sums, arrays_.steps, row));
  plan_embedding_gradients(runtime, sums, arrays_.sequences, object_column(), embeddings_.object,
                           grad.object);
}

void DynamicsMlp::plan_embedding_gradients(Runtime& runtime, const MatrixView& grad_sums, int rows,
                                           int column, const Buffer<float>& inputs,
                                           const Buffer<float>& grad_inputs) {
  const int hidden = spec_.hidden, size = spec_.embedding;
  backward_.push_back(gemm(runtime, grad_sums.transposed(), {inputs, 0, size}, {},
                           weights_.grad("dynamics.0.weight").from_column(column), hidden, size,
                           rows));
  if (grad_inputs.size() > 0)
    backward_.push_back(gemm(runtime, grad_sums,
                             weights_.value("dynamics.0.weight").from_column(column), {},
                             {grad_inputs, 0, size}, rows, size, hidden));
}

void DynamicsMlp::plan_weight_gradients(Runtime& runtime) {
  const int rows = arrays_.sequences * arrays_.steps, state = spec_.state, hidden = spec_.hidden;
  const auto add = [&](const MatrixView& grad, const MatrixView& input, const MatrixView& to,
                       int outputs, int inputs) {
    backward_.push_back(gemm(runtime, grad.transposed(), input, {}, to, outputs, inputs, rows));
  };
  const auto add_bias = [&](const MatrixView& grad, const MatrixView& to, int outputs) {
    backward_.push_back(column_sums(runtime, grad, to, rows, outputs));
  };
  const MatrixView d_out{gradients_.d_out, 0, 2 * state_lanes}, d_h2{gradients_.d_h2, 0, hidden},
      d_h1{gradients_.d_h1, 0, hidden};
  const auto w1 = weights_.grad("dynamics.0.weight"), w3 = weights_.grad("dynamics.4.weight");
  for (int part = 0; part < 2; ++part) {  // delta, band
    const auto grad = d_out.from_column(part * state_lanes);
    add(grad, {arrays_.h2, 0, hidden}, w3.from_row(part * state), state, hidden);
    add_bias(grad, weights_.grad("dynamics.4.bias").from_column(part * state), state);
  }
  add(d_h2, {arrays_.h1, 0, hidden}, weights_.grad("dynamics.2.weight"), hidden, hidden);
  add_bias(d_h2, weights_.grad("dynamics.2.bias"), hidden);
  add(d_h1, {arrays_.states, 0, state_lanes}, w1, hidden, state);
  add_bias(d_h1, weights_.grad("dynamics.0.bias"), hidden);
}

}  // namespace touchtrace
