#include "engine/check/gru_rollout_reference.h"

#include <cmath>
#include <cstddef>

#include "engine/check/dense_reference.h"
#include "engine/ops/rollout_steps.h"

namespace touchtrace {
namespace {

using GruValues = std::vector<double>;

/// Logistic function.
double gate_of(double x) { return 1.0 / (1.0 + std::exp(-x)); }

struct GruLayers {
  DenseShape state, hidden, out;
};

GruLayers layers_of_gru(const RolloutShape& s) {
  return {{s.sequences, s.state, 3 * s.hidden},
          {s.sequences, s.hidden, 3 * s.hidden},
          {s.sequences, s.hidden, 2 * s.state}};
}

/// Index of the reset gate of hidden value `i` in rows of three gates. z and n follow at distances
/// `hidden` and 2 `hidden`.
std::size_t reset_of(std::size_t i, std::size_t hidden) {
  return i / hidden * 3 * hidden + i % hidden;
}

/// Appends gates and the next hidden state, from the input and hidden pre-activations, [S, 3
/// hidden] each.
void append_cell(std::size_t hidden, const GruValues& x, const GruValues& y,
                 const GruValues& before, GruTrace& trace) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    const auto at = reset_of(i, hidden);
    const double r = gate_of(x[at] + y[at]), z = gate_of(x[at + hidden] + y[at + hidden]);
    const double a = y[at + 2 * hidden], n = std::tanh(x[at + 2 * hidden] + r * a);
    trace.r.push_back(r), trace.z.push_back(z), trace.n.push_back(n), trace.a.push_back(a);
    trace.h.push_back((1 - z) * n + z * before[i]);
  }
}

/// Gradients of one step: input and hidden pre-activations, and the direct path to the last hidden
/// state.
struct CellGradient {
  GruValues x, y, before;
};

CellGradient cell_gradient(const RolloutShape& s, const GruTrace& trace, int t,
                           const GruValues& d_h) {
  const std::size_t hidden = s.hidden, size = d_h.size();
  CellGradient grad{GruValues(3 * size), GruValues(3 * size), GruValues(size)};
  for (std::size_t i = 0; i < size; ++i) {
    const auto step = t * size + i, at = reset_of(i, hidden);
    const double r = trace.r[step], z = trace.z[step], n = trace.n[step];
    const double d_n = d_h[i] * (1 - z) * (1 - n * n);
    grad.x[at] = grad.y[at] = d_n * trace.a[step] * r * (1 - r);
    grad.x[at + hidden] = grad.y[at + hidden] = d_h[i] * (trace.h[step] - n) * z * (1 - z);
    grad.x[at + 2 * hidden] = d_n;
    grad.y[at + 2 * hidden] = d_n * r;
    grad.before[i] = d_h[i] * z;
  }
  return grad;
}

}  // namespace

GruTrace gru_rollout_reference(const RolloutShape& s, const GruValues& initial,
                               const GruValues& initial_h, const GruValues& input_projection,
                               const GruWeights& w) {
  const auto layers = layers_of_gru(s);
  const auto size = std::size_t(s.sequences) * s.state, gates = initial_h.size() * 3;
  GruTrace trace{initial, initial_h, {}, {}, {}, {}, {}};
  for (int t = 0; t < s.steps; ++t) {
    auto x = dense_reference(layers.state, step_of(trace.states, t, size), w.w, {});
    for (std::size_t i = 0; i < gates; ++i)
      x[i] += s.shared_input_projection ? input_projection[i % (3 * s.hidden)]
                                        : input_projection[t * gates + i];
    const auto before = step_of(trace.h, t, initial_h.size());
    append_cell(s.hidden, x, dense_reference(layers.hidden, before, w.u, w.bias), before, trace);
    const auto now = step_of(trace.h, t + 1, initial_h.size());
    append_prediction(dense_reference(layers.out, now, w.w3, w.b3), s.state, trace.states,
                      trace.spread);
  }
  return trace;
}

GruReferenceGradients gru_rollout_backward_reference(const RolloutShape& s, const GruTrace& trace,
                                                     const GruWeights& w,
                                                     const GruValues& grad_state,
                                                     const GruValues& grad_spread) {
  const auto layers = layers_of_gru(s);
  const auto size = std::size_t(s.sequences) * s.state,
             hidden = std::size_t(s.sequences) * s.hidden;
  GruReferenceGradients grad;
  grad.input_projection.resize((s.shared_input_projection ? 1 : s.steps * s.sequences) * 3 *
                               s.hidden);
  GruValues carry(size, 0.0), d_h(hidden, 0.0);
  for (int t = s.steps - 1; t >= 0; --t) {
    add(carry, step_of(grad_state, t, size));
    const auto d_out = output_gradient(s.state, carry, step_of(grad_spread, t, size),
                                       step_of(trace.spread, t, size));
    const auto out =
        dense_backward_reference(layers.out, step_of(trace.h, t + 1, hidden), w.w3, d_out);
    add(d_h, out.in);
    const auto cell = cell_gradient(s, trace, t, d_h);
    const auto x =
        dense_backward_reference(layers.state, step_of(trace.states, t, size), w.w, cell.x);
    const auto y =
        dense_backward_reference(layers.hidden, step_of(trace.h, t, hidden), w.u, cell.y);
    for (std::size_t i = 0; i < cell.x.size(); ++i)
      grad.input_projection[s.shared_input_projection ? i % (3 * s.hidden)
                                                      : t * cell.x.size() + i] += cell.x[i];
    d_h = cell.before;
    add(d_h, y.in), add(carry, x.in);
    add(grad.weights.w, x.weight);
    add(grad.weights.u, y.weight), add(grad.weights.bias, y.bias);
    add(grad.weights.w3, out.weight), add(grad.weights.b3, out.bias);
  }
  return grad;
}

}  // namespace touchtrace
