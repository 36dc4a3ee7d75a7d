#include "engine/model/model_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/ops/conv2d_reference.h"
#include "engine/ops/dense_reference.h"
#include "engine/ops/layer_norm_reference.h"
#include "engine/ops/rollout_reference.h"
#include "engine/ops/state_loss_reference.h"
#include "engine/ops/tactile_window_reference.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

/// Parameters read by name, and their gradients written by name.
struct Flat {
  const ParameterTable& table;
  const Values& values;
  Values gradient;

  Values operator[](const std::string& name) const {
    const auto& row = table.at(name);
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row.offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(row.size)};
  }
  void set(const std::string& name, const Values& grad) {
    std::ranges::copy(grad, gradient.begin() + static_cast<std::ptrdiff_t>(table.at(name).offset));
  }
};

/// The tactile encoder with what its gradient needs.
struct EncoderTrace {
  std::array<Conv2dShape, 3> shapes;
  std::array<Values, 4> layers;  ///< the windows, then the layers' outputs
  std::array<Values, 3> sums;    ///< before the ReLUs
  Values dense, embedding;

  DenseShape dense_shape() const {
    const int windows = shapes[0].images;
    return {windows, int(layers[3].size()) / windows, int(dense.size()) / windows};
  }
};

std::string conv(int layer) { return "tactile.conv" + std::to_string(layer); }

EncoderTrace encode(const ModelSpec& spec, const Flat& p, const ModelProblem& problem) {
  constexpr std::array channels{32, 64, 128};
  const int windows = problem.sequences * problem.steps;
  EncoderTrace trace;
  trace.layers[0] = tactile_window_reference({windows, spec.window_frames, spec.rows, spec.cols},
                                             problem.stream, problem.last_frame, problem.dropout);
  Conv2dShape shape{windows, spec.window_frames, spec.rows, spec.cols, channels[0], true};
  for (int i = 0; i < 3; ++i) {
    shape.out_channels = channels[i];
    trace.shapes[i] = shape;
    trace.sums[i] = conv2d_sum_reference(shape, trace.layers[i], p[conv(i + 1) + ".weight"],
                                         p[conv(i + 1) + ".bias"]);
    for (double sum : trace.sums[i]) trace.layers[i + 1].push_back(std::max(sum, 0.0));
    shape = {windows, channels[i], shape.out_rows(), shape.out_cols(), 0, false};
  }
  trace.dense.resize(std::size_t(windows) * spec.embedding);
  trace.dense = dense_reference(trace.dense_shape(), trace.layers[3], p["tactile.dense.weight"],
                                p["tactile.dense.bias"]);
  trace.embedding =
      layer_norm_reference(trace.dense, p["tactile.norm.weight"], p["tactile.norm.bias"]);
  return trace;
}

void encode_backward(const EncoderTrace& trace, const Values& grad_embedding, Flat& p) {
  const auto norm =
      layer_norm_backward_reference(trace.dense, p["tactile.norm.weight"], grad_embedding);
  p.set("tactile.norm.weight", norm.gain), p.set("tactile.norm.bias", norm.bias);
  const auto dense = dense_backward_reference(trace.dense_shape(), trace.layers[3],
                                              p["tactile.dense.weight"], norm.x);
  p.set("tactile.dense.weight", dense.weight), p.set("tactile.dense.bias", dense.bias);
  Values grad = dense.in;
  for (int i = 3; i >= 1; --i) {
    for (std::size_t j = 0; j < grad.size(); ++j)
      if (!(trace.layers[i][j] > 0)) grad[j] = 0.0;
    auto below = conv2d_backward_reference(trace.shapes[i - 1], trace.layers[i - 1],
                                           p[conv(i) + ".weight"], grad);
    p.set(conv(i) + ".weight", below.weight), p.set(conv(i) + ".bias", below.bias);
    grad = std::move(below.in);
  }
}

/// Columns [begin, end) of a matrix of rows of `columns`.
Values columns_of(const Values& matrix, int columns, int begin, int end) {
  Values part;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    if (int(i % columns) >= begin && int(i % columns) < end) part.push_back(matrix[i]);
  return part;
}

/// The loss, and its gradients towards the predicted states and the spread.
double state_loss(const ModelProblem& problem, int state, const RolloutTrace& trace,
                  Values& grad_state, Values& grad_spread) {
  double loss = 0.0;
  const std::size_t first = problem.initial.size();
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double weight = problem.weight[i / state];
    const auto part =
        state_loss_reference(trace.states[first + i], trace.spread[i], problem.target[i]);
    loss += weight * part.value;
    grad_state.push_back(weight * part.grad_state);
    grad_spread.push_back(weight * part.grad_spread);
  }
  return loss;
}

double kink_distance(const ModelProblem& problem, const EncoderTrace& encoded,
                     const RolloutTrace& trace) {
  double distance = std::abs(trace.sum1.front());
  for (const auto* sums :
       {&encoded.sums[0], &encoded.sums[1], &encoded.sums[2], &trace.sum1, &trace.sum2})
    for (double sum : *sums) distance = std::min(distance, std::abs(sum));
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double error = problem.target[i] - trace.states[problem.initial.size() + i];
    for (double quantile : {-trace.spread[i], 0.0, trace.spread[i]})
      distance = std::min(distance, std::abs(error - quantile));
  }
  return distance;
}

/// Layer 1's weight is [state | embedding]; the roll-out knows the first part, a dense layer the
/// other.
struct FirstLayer {
  int state, embedding, hidden;

  int inputs() const { return state + embedding; }
  DenseShape hoisted(int rows) const { return {rows, embedding, hidden}; }
  Values state_part(const Values& w) const { return columns_of(w, inputs(), 0, state); }
  Values embedding_part(const Values& w) const { return columns_of(w, inputs(), state, inputs()); }
  Values joined(const Values& of_state, const Values& of_embedding) const {
    Values w;
    for (int o = 0; o < hidden; ++o) {
      w.insert(w.end(), of_state.begin() + o * state, of_state.begin() + (o + 1) * state);
      w.insert(w.end(), of_embedding.begin() + o * embedding,
               of_embedding.begin() + (o + 1) * embedding);
    }
    return w;
  }
};

void set_rollout_gradients(const RolloutReferenceGradients& grad, Flat& p) {
  p.set("dynamics.2.weight", grad.weights.w2), p.set("dynamics.2.bias", grad.weights.b2);
  p.set("dynamics.4.weight", grad.weights.w3), p.set("dynamics.4.bias", grad.weights.b3);
}

}  // namespace

LossAndGradient model_reference(const ModelSpec& spec, const ParameterTable& table,
                                const Values& parameters, const ModelProblem& problem) {
  Flat p{table, parameters, Values(table.size(), 0.0)};
  const int rows = problem.sequences * problem.steps;
  const FirstLayer layer{spec.state, spec.touch ? spec.embedding : 0, spec.hidden};
  const RolloutShape shape{problem.sequences, problem.steps, spec.state, spec.hidden, !spec.touch};
  const auto w1 = p["dynamics.0.weight"];
  const RolloutWeights weights{layer.state_part(w1), p["dynamics.2.weight"], p["dynamics.2.bias"],
                               p["dynamics.4.weight"], p["dynamics.4.bias"]};
  const auto encoded = spec.touch ? encode(spec, p, problem) : EncoderTrace{};
  const auto first = spec.touch ? dense_reference(layer.hoisted(rows), encoded.embedding,
                                                  layer.embedding_part(w1), p["dynamics.0.bias"])
                                : p["dynamics.0.bias"];
  const auto trace = rollout_reference(shape, problem.initial, first, weights);
  Values grad_state, grad_spread;
  const double loss = state_loss(problem, spec.state, trace, grad_state, grad_spread);
  const auto grad = rollout_backward_reference(shape, trace, weights, grad_state, grad_spread);
  const double distance = kink_distance(problem, encoded, trace);
  set_rollout_gradients(grad, p);
  if (!spec.touch) {
    p.set("dynamics.0.weight", grad.weights.w1), p.set("dynamics.0.bias", grad.first);
    return {loss, p.gradient, distance};
  }
  const auto hoisted = dense_backward_reference(layer.hoisted(rows), encoded.embedding,
                                                layer.embedding_part(w1), grad.first);
  p.set("dynamics.0.weight", layer.joined(grad.weights.w1, hoisted.weight));
  p.set("dynamics.0.bias", hoisted.bias);
  encode_backward(encoded, hoisted.in, p);
  return {loss, p.gradient, distance};
}

}  // namespace touchtrace
