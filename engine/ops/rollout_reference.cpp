#include "engine/ops/rollout_reference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/ops/dense_reference.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

void append(Values& all, const Values& part) { all.insert(all.end(), part.begin(), part.end()); }

void add(Values& sum, const Values& part) {
  if (sum.empty()) sum.resize(part.size(), 0.0);
  for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
}

/// Step `t` of an array of equal parts a step.
Values step(const Values& all, int t, std::size_t size) {
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(t * size);
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

struct Layers {
  DenseShape first, second, third;
};

Layers layers_of(const RolloutShape& s) {
  return {{s.sequences, s.state, s.hidden},
          {s.sequences, s.hidden, s.hidden},
          {s.sequences, s.hidden, 2 * s.state}};
}

/// The next states and the spread from the last layer's [S, 2 state].
void advance(const RolloutShape& s, const Values& out, RolloutTrace& trace) {
  const auto now = trace.states.size() - std::size_t(s.sequences) * s.state;
  for (int i = 0; i < s.sequences * s.state; ++i) {
    const auto delta = std::size_t(i / s.state) * 2 * s.state + i % s.state;
    trace.states.push_back(trace.states[now + i] + out[delta]);
    trace.spread.push_back(softplus(out[delta + s.state]));
  }
}

/// Towards the last layer's output, from dl/ds(t+1) and the gradient towards the spread.
Values output_gradient(const RolloutShape& s, const Values& carry, const Values& grad_spread,
                       const Values& spread) {
  Values grad(2 * carry.size());
  for (std::size_t i = 0; i < carry.size(); ++i) {
    const auto delta = i / s.state * 2 * s.state + i % s.state;
    grad[delta] = carry[i];
    grad[delta + s.state] = grad_spread[i] * -std::expm1(-spread[i]);
  }
  return grad;
}

}  // namespace

RolloutTrace rollout_reference(const RolloutShape& s, const Values& initial, const Values& first,
                               const RolloutWeights& w) {
  const auto layers = layers_of(s);
  const auto activated = [&](const Values& sums) {
    return activation_reference(s.activation, sums);
  };
  const auto hidden = std::size_t(s.sequences) * s.hidden,
             size = std::size_t(s.sequences) * s.state;
  RolloutTrace trace{initial, {}, {}, {}};
  for (int t = 0; t < s.steps; ++t) {
    auto sum1 = dense_reference(layers.first, step(trace.states, t, size), w.w1, {});
    for (std::size_t i = 0; i < hidden; ++i)
      sum1[i] += s.shared_first ? first[i % s.hidden] : first[t * hidden + i];
    const auto sum2 = dense_reference(layers.second, activated(sum1), w.w2, w.b2);
    advance(s, dense_reference(layers.third, activated(sum2), w.w3, w.b3), trace);
    append(trace.sum1, sum1);
    append(trace.sum2, sum2);
  }
  return trace;
}

RolloutReferenceGradients rollout_backward_reference(const RolloutShape& s,
                                                     const RolloutTrace& trace,
                                                     const RolloutWeights& w,
                                                     const Values& grad_state,
                                                     const Values& grad_spread) {
  const auto layers = layers_of(s);
  const auto activated = [&](const Values& sums) {
    return activation_reference(s.activation, sums);
  };
  const auto hidden = std::size_t(s.sequences) * s.hidden,
             size = std::size_t(s.sequences) * s.state;
  RolloutReferenceGradients grad;
  grad.first.resize(s.shared_first ? s.hidden : s.steps * hidden);
  Values carry(size, 0.0);
  for (int t = s.steps - 1; t >= 0; --t) {
    const auto sum1 = step(trace.sum1, t, hidden), sum2 = step(trace.sum2, t, hidden);
    add(carry, step(grad_state, t, size));
    const auto d_out =
        output_gradient(s, carry, step(grad_spread, t, size), step(trace.spread, t, size));
    auto third = dense_backward_reference(layers.third, activated(sum2), w.w3, d_out);
    third.in = activation_backward_reference(s.activation, sum2, std::move(third.in));
    auto second = dense_backward_reference(layers.second, activated(sum1), w.w2, third.in);
    second.in = activation_backward_reference(s.activation, sum1, std::move(second.in));
    const auto first =
        dense_backward_reference(layers.first, step(trace.states, t, size), w.w1, second.in);
    for (std::size_t i = 0; i < hidden; ++i)
      grad.first[s.shared_first ? i % s.hidden : t * hidden + i] += second.in[i];
    add(carry, first.in);
    add(grad.weights.w1, first.weight);
    add(grad.weights.w2, second.weight), add(grad.weights.b2, second.bias);
    add(grad.weights.w3, third.weight), add(grad.weights.b3, third.bias);
  }
  return grad;
}

}  // namespace touchtrace
