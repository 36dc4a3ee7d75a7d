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
  arrays.w1 = runtime.allocate<float>(spec.state * hidden);
  arrays.w2 = runtime.allocate<float>(hidden * hidden);
  arrays.w3 = runtime.allocate<float>(hidden * 2 * state_lanes);
  arrays.b3 = runtime.allocate<float>(2 * state_lanes);
  arrays.states = runtime.allocate<float>((rows + sequences) * state_lanes);
  arrays.h1 = runtime.allocate<float>(rows * hidden);
  arrays.h2 = runtime.allocate<float>(rows * hidden);
  arrays.spread = runtime.allocate<float>(rows * state_lanes);
  return arrays;
}

}  // namespace

void DynamicsMlp::declare(const ModelSpec& spec, ParameterTable& table) {
  add_layer(table, "dynamics.0", spec.hidden, spec.state + (spec.touch ? spec.embedding : 0));
  add_layer(table, "dynamics.2", spec.hidden, spec.hidden);
  add_layer(table, "dynamics.4", 2 * spec.state, spec.hidden);
}

DynamicsMlp::DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                         const Buffer<float>& embedding, int sequences, int steps)
    : spec_(spec),
      weights_(weights),
      embedding_(embedding),
      arrays_(allocate(runtime, spec, sequences, steps)) {
  arrays_.parameters = weights.values;
  arrays_.b2_at = weights.value("dynamics.2.bias").at;
  arrays_.w2_at = weights.value("dynamics.2.weight").at;
  arrays_.w3_at = weights.value("dynamics.4.weight").at;
  arrays_.first = weights.value("dynamics.0.bias");
  plan_prepare(runtime);
  if (spec.touch) plan_hoisted(runtime);
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

void DynamicsMlp::plan_hoisted(Runtime& runtime) {
  const int rows = arrays_.sequences * arrays_.steps, hidden = spec_.hidden;
  const MatrixView by_input{runtime.allocate<float>(std::size_t(spec_.embedding) * hidden), 0,
                            hidden};
  const auto weight = weights_.value("dynamics.0.weight").from_column(spec_.state);
  prepare_.push_back(pack(runtime, weight.transposed(), by_input, spec_.embedding, hidden, hidden));
  arrays_.first = {runtime.allocate<float>(std::size_t(rows) * hidden), 0, hidden};
  forward_ = {gemm(runtime, {embedding_, 0, spec_.embedding}, by_input,
                   weights_.value("dynamics.0.bias"), arrays_.first, rows, hidden,
                   spec_.embedding)};
}

void DynamicsMlp::plan_backward(Runtime& runtime, const Buffer<float>& grad_embedding) {
  const auto rows = std::size_t(arrays_.sequences) * arrays_.steps;
  const int state = spec_.state, hidden = spec_.hidden, size = spec_.embedding;
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
    backward_.push_back(gemm(runtime, {gradients_.d_h1, 0, hidden}, w1.from_column(state), {},
                             {grad_embedding, 0, size}, int(rows), size, hidden));
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
  if (spec_.touch)
    add(d_h1, {embedding_, 0, spec_.embedding}, w1.from_column(state), hidden, spec_.embedding);
}

}  // namespace touchtrace
