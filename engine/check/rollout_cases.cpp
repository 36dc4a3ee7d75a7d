// Operation `rollout`. Inputs: initial states, input projection, w1, w2, b2, w3, b3. Outputs:
// predicted states, spread. The model computes weight gradients by GEMMs; here the host sums them
// from the output of the backward kernel.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/dense_reference.h"
#include "engine/check/host_arrays.h"
#include "engine/check/rollout_reference.h"
#include "engine/check/rows.h"
#include "engine/ops/rollout.h"
#include "engine/ops/rollout_steps.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

std::size_t row_count(const RolloutShape& s) { return std::size_t(s.sequences) * s.steps; }

RolloutWeights weights_of(const Arrays& in) { return {in[2], in[3], in[4], in[5], in[6]}; }

Arrays reference(const RolloutShape& s, const Arrays& in) {
  auto trace = rollout_reference(s, in[0], in[1], weights_of(in));
  trace.states.erase(trace.states.begin(), trace.states.begin() + std::ptrdiff_t(in[0].size()));
  return {trace.states, trace.spread};
}

Arrays reference_backward(const RolloutShape& s, const Arrays& in, const Arrays& grads) {
  const auto weights = weights_of(in);
  const auto trace = rollout_reference(s, in[0], in[1], weights);
  const auto grad = rollout_backward_reference(s, trace, weights, grads[0], grads[1]);
  const auto& w = grad.weights;
  return {{}, grad.input_projection, w.w1, w.w2, w.b2, w.w3, w.b3};
}

/// Arrays on the device after the forward pass.
RolloutArrays rolled_out(Runtime& runtime, const RolloutShape& s, const Arrays& in) {
  const auto hidden = row_count(s) * s.hidden;
  RolloutArrays a{
      .sequences = s.sequences,
      .steps = s.steps,
      .state = s.state,
      .hidden = s.hidden,
      .activation = s.activation,
      .parameters = upload(runtime, joined(joined(in[4], in[3]), in[5])),
      .b2_at = 0,
      .w2_at = s.hidden,
      .w3_at = s.hidden + s.hidden * s.hidden,
      .w1 = upload(runtime, transposed(in[2], s.hidden, s.state)),
      .w2 = upload(runtime, transposed(in[3], s.hidden, s.hidden)),
      .w3 = upload(runtime,
                   padded_rows(transposed(in[5], 2 * s.state, s.hidden), s.state, state_lanes)),
      .b3 = upload(runtime, padded_rows(in[6], s.state, state_lanes)),
      .input_projection = {upload(runtime, in[1]), 0, s.shared_input_projection ? 0 : s.hidden},
      .states = runtime.allocate<float>((row_count(s) + s.sequences) * state_lanes),
      .h1 = runtime.allocate<float>(hidden),
      .h2 = runtime.allocate<float>(hidden),
      .pre_activation1 = runtime.allocate<float>(slope_from_sum(s.activation) ? hidden : 0),
      .pre_activation2 = runtime.allocate<float>(slope_from_sum(s.activation) ? hidden : 0),
      .spread = runtime.allocate<float>(row_count(s) * state_lanes)};
  const auto initial = padded_rows(in[0], s.state, state_lanes);
  runtime.write<float>(a.states, std::vector<float>(initial.begin(), initial.end()));
  rollout(runtime, a).enqueue(runtime);
  return a;
}

Arrays forward(Runtime& runtime, const RolloutShape& s, const Arrays& in) {
  const auto arrays = rolled_out(runtime, s, in);
  const auto states = split(download(runtime, arrays.states), s.sequences * state_lanes).second;
  return {unpadded_rows(states, s.state, state_lanes),
          unpadded_rows(download(runtime, arrays.spread), s.state, state_lanes)};
}

RolloutGradients gone_back(Runtime& runtime, const RolloutShape& s, const RolloutArrays& arrays,
                           const Arrays& in, const Arrays& grads) {
  const auto hidden = row_count(s) * s.hidden;
  RolloutGradients g{.grad_state = upload(runtime, padded_rows(grads[0], s.state, state_lanes)),
                     .grad_spread = upload(runtime, padded_rows(grads[1], s.state, state_lanes)),
                     .w1 = upload(runtime, padded_rows(in[2], s.state, state_lanes)),
                     .d_out = runtime.allocate<float>(row_count(s) * 2 * state_lanes),
                     .d_h1 = runtime.allocate<float>(hidden),
                     .d_h2 = runtime.allocate<float>(hidden)};
  rollout_backward(runtime, arrays, g).enqueue(runtime);
  return g;
}

Arrays backward(Runtime& runtime, const RolloutShape& s, const Arrays& in, const Arrays& grads) {
  const auto arrays = rolled_out(runtime, s, in);
  const auto g = gone_back(runtime, s, arrays, in, grads);
  const int rows = static_cast<int>(row_count(s));
  const auto layer = [&](int inputs, int outputs, const Values& input, const Values& weight,
                         const Values& grad) {
    return dense_backward_reference({rows, inputs, outputs}, input, weight, grad);
  };
  const auto d_h1 = download(runtime, g.d_h1), d_h2 = download(runtime, g.d_h2);
  const auto d_out = unpadded_rows(download(runtime, g.d_out), s.state, state_lanes);
  auto states = unpadded_rows(download(runtime, arrays.states), s.state, state_lanes);
  states.resize(row_count(s) * s.state);
  const auto first = layer(s.state, s.hidden, states, in[2], d_h1);
  const auto second = layer(s.hidden, s.hidden, download(runtime, arrays.h1), in[3], d_h2);
  const auto third = layer(s.hidden, 2 * s.state, download(runtime, arrays.h2), in[5], d_out);
  return {{},           s.shared_input_projection ? first.bias : d_h1,
          first.weight, second.weight,
          second.bias,  third.weight,
          third.bias};
}

double kink_distance(const RolloutShape& s, const Arrays& in) {
  double distance = 1.0;
  if (!has_kink(s.activation)) return distance;
  const auto trace = rollout_reference(s, in[0], in[1], weights_of(in));
  for (double sum : joined(trace.pre_activation1, trace.pre_activation2))
    distance = std::min(distance, std::abs(sum));
  return distance;
}

OperationCase rollout_case(const RolloutShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} sequences x {} steps, state {}, hidden {}, {}{}", s.sequences, s.steps,
                        s.state, s.hidden, name_of(s.activation),
                        s.shared_input_projection ? ", no touch" : "");
  const std::size_t state = s.state, hidden = s.hidden;
  c.input_sizes = {s.sequences * state,
                   (s.shared_input_projection ? 1 : row_count(s)) * hidden,
                   hidden * state,
                   hidden * hidden,
                   hidden,
                   2 * state * hidden,
                   2 * state};
  c.terms = double(hidden) * s.steps;
  c.reference = [s](const Arrays& in) { return reference(s, in); };
  c.forward = [s](Runtime& runtime, const Arrays& in) { return forward(runtime, s, in); };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return reference_backward(s, in, g);
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return backward(runtime, s, in, g);
  };
  c.kink_distance = [s](const Arrays& in) { return kink_distance(s, in); };
  c.prepare = [s](Arrays& in) { scale_weights(in, 2, s.hidden); };
  return c;
}

}  // namespace

Operation rollout_operation() {
  Operation operation{"rollout", {}, 1, true};
  for (const RolloutShape& shape : {RolloutShape{2, 3, 3, 64, false},
                                    {1, 1, 12, 64, true},
                                    {5, 4, 16, 128, true},
                                    {8, 20, 12, 256, false},
                                    {3, 20, 12, 256, true},
                                    {8, 20, 12, 256, false, Activation::silu},
                                    {1, 2, 3, 64, true, Activation::silu},
                                    {8, 20, 12, 256, false, Activation::tanh},
                                    {5, 3, 7, 128, true, Activation::tanh}})
    operation.cases.push_back(rollout_case(shape));
  return operation;
}

}  // namespace touchtrace
