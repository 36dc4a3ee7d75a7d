// Operation `gru_rollout`; one step is a GRU cell. Inputs: initial states, initial hidden states,
// input projection, state columns of weight_ih, weight_hh, bias_hh, w3, b3. Outputs: predicted
// states, spread. The host sums the weight gradients from the output of the backward kernel.
#include <fmt/core.h>

#include <algorithm>

#include "engine/check/dense_reference.h"
#include "engine/check/gru_rollout_reference.h"
#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/gru_rollout.h"
#include "engine/ops/rollout_steps.h"

namespace touchtrace {
namespace {

std::size_t gru_rows(const RolloutShape& s) { return std::size_t(s.sequences) * s.steps; }

GruWeights gru_weights_of(const Arrays& in) { return {in[3], in[4], in[5], in[6], in[7]}; }

GruTrace gru_trace(const RolloutShape& s, const Arrays& in) {
  return gru_rollout_reference(s, in[0], in[1], in[2], gru_weights_of(in));
}

Arrays gru_reference(const RolloutShape& s, const Arrays& in) {
  const auto trace = gru_trace(s, in);
  return {split(trace.states, in[0].size()).second, trace.spread};
}

Arrays gru_reference_backward(const RolloutShape& s, const Arrays& in, const Arrays& grads) {
  const auto grad =
      gru_rollout_backward_reference(s, gru_trace(s, in), gru_weights_of(in), grads[0], grads[1]);
  const auto& w = grad.weights;
  return {{}, {}, grad.input_projection, w.w, w.u, w.bias, w.w3, w.b3};
}

Buffer<float> upload_transposed(Runtime& runtime, const std::vector<double>& weight, int inputs,
                                int hidden) {
  return upload(runtime, padded_rows(transposed(weight, 3 * hidden, inputs), 3 * hidden,
                                     gru_weights_row(hidden)));
}

/// Arrays on the device after the forward pass.
GruArrays gru_rolled_out(Runtime& runtime, const RolloutShape& s, const Arrays& in) {
  const int hidden = s.hidden;
  GruArrays a{
      .sequences = s.sequences,
      .steps = s.steps,
      .state = s.state,
      .hidden = hidden,
      .parameters = upload(runtime, joined(joined(in[5], in[4]), in[6])),
      .bias_at = 0,
      .u_at = 3 * hidden,
      .w3_at = 3 * hidden + 3 * hidden * hidden,
      .w = upload_transposed(runtime, in[3], s.state, hidden),
      .u = upload_transposed(runtime, in[4], hidden, hidden),
      .w3 = upload(runtime,
                   padded_rows(transposed(in[6], 2 * s.state, hidden), s.state, state_lanes)),
      .b3 = upload(runtime, padded_rows(in[7], s.state, state_lanes)),
      .input_projection = {upload(runtime, in[2]), 0, s.shared_input_projection ? 0 : 3 * hidden},
      .states = upload(runtime, joined(padded_rows(in[0], s.state, state_lanes),
                                       std::vector<double>(gru_rows(s) * state_lanes))),
      .h = upload(runtime, joined(in[1], std::vector<double>(gru_rows(s) * hidden))),
      .gates = runtime.allocate<float>(gru_rows(s) * gru_gates_row(hidden)),
      .spread = runtime.allocate<float>(gru_rows(s) * state_lanes)};
  gru_rollout(runtime, a).enqueue(runtime);
  return a;
}

Arrays gru_forward(Runtime& runtime, const RolloutShape& s, const Arrays& in) {
  const auto arrays = gru_rolled_out(runtime, s, in);
  const auto states = unpadded_rows(download(runtime, arrays.states), s.state, state_lanes);
  return {split(states, in[0].size()).second,
          unpadded_rows(download(runtime, arrays.spread), s.state, state_lanes)};
}

GruGradients gru_gone_back(Runtime& runtime, const RolloutShape& s, const GruArrays& arrays,
                           const Arrays& in, const Arrays& grads) {
  GruGradients g{.grad_state = upload(runtime, padded_rows(grads[0], s.state, state_lanes)),
                 .grad_spread = upload(runtime, padded_rows(grads[1], s.state, state_lanes)),
                 .w = upload(runtime, padded_rows(in[3], s.state, state_lanes)),
                 .d_out = runtime.allocate<float>(gru_rows(s) * 2 * state_lanes),
                 .d_gates = runtime.allocate<float>(gru_rows(s) * gru_gates_row(s.hidden)),
                 .d_h = runtime.allocate<float>(std::size_t(s.sequences) * s.hidden)};
  gru_rollout_backward(runtime, arrays, g).enqueue(runtime);
  return g;
}

/// Gradient with respect to the hidden pre-activations: rows d r | d z | d n | d a without d n.
std::vector<double> hidden_side(const std::vector<double>& d_gates, std::size_t hidden) {
  std::vector<double> side;
  for (std::size_t i = 0; i < d_gates.size(); ++i)
    if (i / hidden % 4 != 2) side.push_back(d_gates[i]);
  return side;
}

Arrays gru_backward(Runtime& runtime, const RolloutShape& s, const Arrays& in,
                    const Arrays& grads) {
  const auto arrays = gru_rolled_out(runtime, s, in);
  const auto g = gru_gone_back(runtime, s, arrays, in, grads);
  const int rows = static_cast<int>(gru_rows(s)), hidden = s.hidden;
  const auto d_gates =
      unpadded_rows(download(runtime, g.d_gates), 4 * hidden, gru_gates_row(hidden));
  const auto d_x = unpadded_rows(d_gates, 3 * hidden, 4 * hidden);
  const auto d_out = unpadded_rows(download(runtime, g.d_out), s.state, state_lanes);
  const auto states = split(unpadded_rows(download(runtime, arrays.states), s.state, state_lanes),
                            std::size_t(rows) * s.state);
  const auto h = download(runtime, arrays.h);
  const auto x = dense_backward_reference({rows, s.state, 3 * hidden}, states.first, in[3], d_x);
  const auto y = dense_backward_reference({rows, hidden, 3 * hidden},
                                          split(h, std::size_t(rows) * hidden).first, in[4],
                                          hidden_side(d_gates, hidden));
  const auto out = dense_backward_reference({rows, hidden, 2 * s.state},
                                            split(h, in[1].size()).second, in[6], d_out);
  return {{},         {},      s.shared_input_projection ? x.bias : d_x, x.weight, y.weight, y.bias,
          out.weight, out.bias};
}

OperationCase gru_case(const RolloutShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} sequences x {} steps, state {}, hidden {}{}", s.sequences, s.steps,
                        s.state, s.hidden, s.shared_input_projection ? ", no touch" : "");
  const std::size_t state = s.state, hidden = s.hidden, gates = 3 * hidden;
  c.input_sizes = {s.sequences * state,
                   s.sequences * hidden,
                   (s.shared_input_projection ? 1 : gru_rows(s)) * gates,
                   gates * state,
                   gates * hidden,
                   gates,
                   2 * state * hidden,
                   2 * state};
  c.terms = double(hidden) * s.steps;
  c.reference = [s](const Arrays& in) { return gru_reference(s, in); };
  c.forward = [s](Runtime& runtime, const Arrays& in) { return gru_forward(runtime, s, in); };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return gru_reference_backward(s, in, g);
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return gru_backward(runtime, s, in, g);
  };
  c.prepare = [s](Arrays& in) {
    for (double& value : in[1]) value = std::clamp(value, -1.0, 1.0);  // range of tanh
    scale_weights(in, 3, s.hidden);
  };
  return c;
}

}  // namespace

Operation gru_rollout_operation() {
  Operation operation{"gru_rollout", {}, 1, true};
  for (const RolloutShape& shape : {RolloutShape{2, 3, 3, 64, false},
                                    {1, 1, 12, 64, true},
                                    {5, 4, 16, 128, true},
                                    {8, 20, 12, 256, false},
                                    {3, 20, 12, 256, true}})
    operation.cases.push_back(gru_case(shape));
  return operation;
}

}  // namespace touchtrace
