#include "engine/check/rollout_reference.h"

#include <cstddef>
#include <utility>

#include "engine/check/dense_reference.h"
#include "engine/ops/rollout_steps.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

struct Layers {
  DenseShape first, second, third;
};

Layers layers_of(const RolloutShape& s) {
  return {{s.sequences, s.state, s.hidden},
          {s.sequences, s.hidden, s.hidden},
          {s.sequences, s.hidden, 2 * s.state}};
}

Values activated(const RolloutShape& s, const Values& sums) {
  return activation_reference(s.activation, sums);
}

}  // namespace

RolloutTrace rollout_reference(const RolloutShape& s, const Values& initial,
                               const Values& input_projection, const RolloutWeights& w) {
  const auto layers = layers_of(s);
  const auto hidden = std::size_t(s.sequences) * s.hidden,
             size = std::size_t(s.sequences) * s.state;
  RolloutTrace trace{initial, {}, {}, {}};
  for (int t = 0; t < s.steps; ++t) {
    auto pre_activation1 = dense_reference(layers.first, step_of(trace.states, t, size), w.w1, {});
    for (std::size_t i = 0; i < hidden; ++i)
      pre_activation1[i] += s.shared_input_projection ? input_projection[i % s.hidden]
                                                      : input_projection[t * hidden + i];
    const auto pre_activation2 =
        dense_reference(layers.second, activated(s, pre_activation1), w.w2, w.b2);
    append_prediction(dense_reference(layers.third, activated(s, pre_activation2), w.w3, w.b3),
                      s.state, trace.states, trace.spread);
    append(trace.pre_activation1, pre_activation1);
    append(trace.pre_activation2, pre_activation2);
  }
  return trace;
}

RolloutReferenceGradients rollout_backward_reference(const RolloutShape& s,
                                                     const RolloutTrace& trace,
                                                     const RolloutWeights& w,
                                                     const Values& grad_state,
                                                     const Values& grad_spread) {
  const auto layers = layers_of(s);
  const auto hidden = std::size_t(s.sequences) * s.hidden,
             size = std::size_t(s.sequences) * s.state;
  RolloutReferenceGradients grad;
  grad.input_projection.resize(s.shared_input_projection ? s.hidden : s.steps * hidden);
  Values carry(size, 0.0);
  for (int t = s.steps - 1; t >= 0; --t) {
    const auto pre_activation1 = step_of(trace.pre_activation1, t, hidden),
               pre_activation2 = step_of(trace.pre_activation2, t, hidden);
    add(carry, step_of(grad_state, t, size));
    const auto d_out = output_gradient(s.state, carry, step_of(grad_spread, t, size),
                                       step_of(trace.spread, t, size));
    auto third = dense_backward_reference(layers.third, activated(s, pre_activation2), w.w3, d_out);
    third.in = activation_backward_reference(s.activation, pre_activation2, std::move(third.in));
    auto second =
        dense_backward_reference(layers.second, activated(s, pre_activation1), w.w2, third.in);
    second.in = activation_backward_reference(s.activation, pre_activation1, std::move(second.in));
    const auto first =
        dense_backward_reference(layers.first, step_of(trace.states, t, size), w.w1, second.in);
    for (std::size_t i = 0; i < hidden; ++i)
      grad.input_projection[s.shared_input_projection ? i % s.hidden : t * hidden + i] +=
          second.in[i];
    add(carry, first.in);
    add(grad.weights.w1, first.weight);
    add(grad.weights.w2, second.weight), add(grad.weights.b2, second.bias);
    add(grad.weights.w3, third.weight), add(grad.weights.b3, third.bias);
  }
  return grad;
}

}  // namespace touchtrace
