#include "engine/model/dynamics_mlp.h"

#include <cmath>

namespace touchtrace {
namespace {

const DynamicsInput::Names mlp_input{"dynamics.0.weight", "dynamics.0.bias"};
constexpr const char* mlp_output = "dynamics.4";

}  // namespace

void DynamicsMlp::declare(const ModelSpec& spec, ParameterTable& table) {
  DynamicsInput::declare(spec, mlp_input, spec.hidden, 1.0 / std::sqrt(DynamicsInput::inputs(spec)),
                         table);
  const Initial hidden{0.0, 1.0 / std::sqrt(spec.hidden)};
  table.add("dynamics.2.weight", {spec.hidden, spec.hidden}, hidden);
  table.add("dynamics.2.bias", {spec.hidden}, hidden);
  DynamicsOutput::declare(spec, mlp_output, table);
}

DynamicsMlp::DynamicsMlp(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                         const Embeddings& embeddings, int sequences, int steps)
    : Dynamics(runtime, sequences, steps),
      weights_(weights),
      input_(runtime, spec, weights, mlp_input, embeddings, sequences, steps, spec.hidden),
      output_(runtime, spec, weights, mlp_output),
      arrays_{.sequences = sequences,
              .steps = steps,
              .state = spec.state,
              .hidden = spec.hidden,
              .activation = spec.activation,
              .parameters = weights.values,
              .b2_at = weights.value("dynamics.2.bias").at,
              .w2_at = weights.value("dynamics.2.weight").at,
              .w3_at = output_.weight_at(),
              .w1 = input_.state_weight(),
              .w2 = runtime.allocate<float>(std::size_t(spec.hidden) * spec.hidden),
              .w3 = output_.weight(),
              .b3 = output_.bias(),
              .input_projection = input_.input_projection(),
              .states = states_,
              .h1 = {},
              .h2 = {},
              .pre_activation1 = {},
              .pre_activation2 = {},
              .spread = spread_} {
  const auto values = std::size_t(sequences) * steps * spec.hidden;
  for (auto* values_of : {&arrays_.h1, &arrays_.h2}) *values_of = runtime.allocate<float>(values);
  if (slope_from_sum(spec.activation))
    for (auto* sums : {&arrays_.pre_activation1, &arrays_.pre_activation2})
      *sums = runtime.allocate<float>(values);
  append(prepare_, input_.prepare());
  prepare_.push_back(pack(runtime, weights.value("dynamics.2.weight").transposed(),
                          {arrays_.w2, 0, spec.hidden}, spec.hidden, spec.hidden, spec.hidden));
  append(prepare_, output_.prepare());
  append(forward_, input_.forward());
  forward_.push_back(rollout(runtime, arrays_));
}

void DynamicsMlp::plan_backward(Runtime& runtime, const Embeddings& grad) {
  const int rows = arrays_.sequences * arrays_.steps, hidden = arrays_.hidden;
  allocate_gradients(runtime);
  const auto array = [&](int columns) {
    return runtime.allocate<float>(std::size_t(rows) * columns);
  };
  const MatrixView d_h1{array(hidden), 0, hidden}, d_h2{array(hidden), 0, hidden};
  const auto d_out = array(2 * state_lanes);
  input_.plan_backward(runtime, d_h1, states_, grad);
  output_.plan_backward(runtime, d_out, {arrays_.h2, 0, hidden}, rows);
  backward_ = {rollout_backward(runtime, arrays_,
                                {.grad_state = grad_state_,
                                 .grad_spread = grad_spread_,
                                 .w1 = input_.padded_state_weight(),
                                 .d_out = d_out,
                                 .d_h1 = d_h1.buffer,
                                 .d_h2 = d_h2.buffer})};
  append(backward_, output_.backward());
  append(backward_, gemm(runtime, d_h2.transposed(), {arrays_.h1, 0, hidden}, {},
                         weights_.grad("dynamics.2.weight"), hidden, hidden, rows));
  backward_.push_back(column_sums(runtime, d_h2, weights_.grad("dynamics.2.bias"), rows, hidden));
  append(backward_, input_.backward());
}

}  // namespace touchtrace
