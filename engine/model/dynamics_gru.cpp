#include "engine/model/dynamics_gru.h"

#include <cmath>

namespace touchtrace {
namespace {

const DynamicsInput::Names gru_input{"dynamics.cell.weight_ih", "dynamics.cell.bias_ih"};
constexpr const char *weight_hh = "dynamics.cell.weight_hh", *bias_hh = "dynamics.cell.bias_hh",
                     *gru_output = "dynamics.out";

}  // namespace

void DynamicsGru::declare(const ModelSpec& spec, ParameterTable& table) {
  const Initial initial{0.0, 1.0 / std::sqrt(spec.hidden)};
  DynamicsInput::declare(spec, gru_input, 3 * spec.hidden, initial.half_range, table);
  table.add(weight_hh, {3 * spec.hidden, spec.hidden}, initial);
  table.add(bias_hh, {3 * spec.hidden}, initial);
  DynamicsOutput::declare(spec, gru_output, table);
}

DynamicsGru::DynamicsGru(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                         const Embeddings& embeddings, int sequences, int steps)
    : Dynamics(runtime, sequences, steps),
      weights_(weights),
      input_(runtime, spec, weights, gru_input, embeddings, sequences, steps,
             gru_weights_row(spec.hidden)),
      output_(runtime, spec, weights, gru_output),
      arrays_{
          .sequences = sequences,
          .steps = steps,
          .state = spec.state,
          .hidden = spec.hidden,
          .parameters = weights.values,
          .bias_at = weights.value(bias_hh).at,
          .u_at = weights.value(weight_hh).at,
          .w3_at = output_.weight_at(),
          .w = input_.state_weight(),
          .u = runtime.allocate<float>(std::size_t(spec.hidden) * gru_weights_row(spec.hidden)),
          .w3 = output_.weight(),
          .b3 = output_.bias(),
          .input_projection = input_.input_projection(),
          .states = states_,
          .h = runtime.allocate_zeros<float>((std::size_t(steps) + 1) * sequences * spec.hidden),
          .gates =
              runtime.allocate<float>(std::size_t(steps) * sequences * gru_gates_row(spec.hidden)),
          .spread = spread_} {
  const int hidden = spec.hidden;
  append(prepare_, input_.prepare());
  prepare_.push_back(pack(runtime, weights.value(weight_hh).transposed(),
                          {arrays_.u, 0, gru_weights_row(hidden)}, hidden, 3 * hidden, 3 * hidden));
  append(prepare_, output_.prepare());
  append(forward_, input_.forward());
  forward_.push_back(gru_rollout(runtime, arrays_));
  carry_state_.push_back(pack(runtime, {arrays_.h, steps * sequences * hidden, hidden},
                              {arrays_.h, 0, hidden}, sequences, hidden, hidden));
}

void DynamicsGru::plan_backward(Runtime& runtime, const Embeddings& grad) {
  const int rows = arrays_.sequences * arrays_.steps, hidden = arrays_.hidden;
  allocate_gradients(runtime);
  // Zeroed, since column sums also read the gaps between rows.
  const MatrixView d_gates{runtime.allocate_zeros<float>(std::size_t(rows) * gru_gates_row(hidden)),
                           0, gru_gates_row(hidden)};
  const auto d_out = runtime.allocate<float>(std::size_t(rows) * 2 * state_lanes);
  const MatrixView h_after{arrays_.h, arrays_.sequences * hidden, hidden};
  input_.plan_backward(runtime, d_gates, states_, grad);
  output_.plan_backward(runtime, d_out, h_after, rows);
  backward_ = {gru_rollout_backward(
      runtime, arrays_,
      {.grad_state = grad_state_,
       .grad_spread = grad_spread_,
       .w = input_.padded_state_weight(),
       .d_out = d_out,
       .d_gates = d_gates.buffer,
       .d_h = runtime.allocate<float>(std::size_t(arrays_.sequences) * hidden)})};
  append(backward_, output_.backward());
  plan_hidden_gradients(runtime, d_gates);
  append(backward_, input_.backward());
}

void DynamicsGru::plan_hidden_gradients(Runtime& runtime, const MatrixView& d_gates) {
  const int rows = arrays_.sequences * arrays_.steps, hidden = arrays_.hidden;
  const MatrixView h_before{arrays_.h, 0, hidden};
  const auto add = [&](int gate, int from, int gates) {
    const auto grad = d_gates.from_column(from * hidden);
    append(backward_,
           gemm(runtime, grad.transposed(), h_before, {},
                weights_.grad(weight_hh).from_row(gate * hidden), gates * hidden, hidden, rows));
    backward_.push_back(column_sums(
        runtime, grad, weights_.grad(bias_hh).from_column(gate * hidden), rows, gates * hidden));
  };
  add(0, 0, 2);  // reset and update
  add(2, 3, 1);  // new: the term that reset scales
}

}  // namespace touchtrace
