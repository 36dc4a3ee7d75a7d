#include "engine/model/model_reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/model/encoder_reference.h"
#include "engine/model/touch_encoder.h"
#include "engine/ops/dense_reference.h"
#include "engine/ops/info_nce_reference.h"
#include "engine/ops/rollout_reference.h"
#include "engine/ops/state_loss_reference.h"
#include "engine/ops/tactile_window_reference.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

/// Columns [begin, end) of a matrix of rows of `columns`.
Values columns_of(const Values& matrix, int columns, int begin, int end) {
  Values part;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    if (int(i % columns) >= begin && int(i % columns) < end) part.push_back(matrix[i]);
  return part;
}

/// The loss, and its gradients towards the predicted states and the spread.
double state_loss(const ModelProblem& problem, const ModelSpec& spec, const RolloutTrace& trace,
                  Values& grad_state, Values& grad_spread) {
  double loss = 0.0;
  const std::size_t first = problem.initial.size();
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double weight = problem.weight[i / spec.state];
    const auto part = state_loss_reference(trace.states[first + i], trace.spread[i],
                                           problem.target[i], spec.band_quantile);
    loss += weight * part.value;
    grad_state.push_back(weight * part.grad_state);
    grad_spread.push_back(weight * part.grad_spread);
  }
  return loss;
}

double kink_distance(const ModelSpec& spec, const ModelProblem& problem,
                     const std::vector<EncoderTrace>& encoders, const RolloutTrace& trace) {
  double distance = 1.0;
  const auto add = [&](const Values& sums) {
    for (double sum : sums) distance = std::min(distance, std::abs(sum));
  };
  for (const auto& encoder : encoders)
    for (const auto& sums : encoder.sums) add(sums);
  if (has_kink(spec.activation)) add(trace.sum1), add(trace.sum2);
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double error = problem.target[i] - trace.states[problem.initial.size() + i];
    for (double quantile : {-trace.spread[i], 0.0, trace.spread[i]})
      distance = std::min(distance, std::abs(error - quantile));
  }
  return distance;
}

/// What layer 1 sees beside the state: for each row of [T][S] the embeddings that there are.
Values joined_embeddings(const std::vector<EncoderTrace>& encoders, std::size_t rows, int size) {
  Values joined;
  for (std::size_t row = 0; row < rows; ++row)
    for (const auto& encoder : encoders) {
      const auto own_rows = encoder.embedding.size() / size;  // T S of touch, S of objects
      const auto begin = encoder.embedding.begin() + std::ptrdiff_t(row % own_rows) * size;
      joined.insert(joined.end(), begin, begin + size);
    }
  return joined;
}

/// The gradient towards encoder number `which`'s embedding, from that towards joined_embeddings.
Values embedding_gradient(const Values& joined, const EncoderTrace& encoder, int columns, int size,
                          int which) {
  const auto part = columns_of(joined, columns, which * size, (which + 1) * size);
  Values grad(encoder.embedding.size(), 0.0);
  for (std::size_t i = 0; i < part.size(); ++i) grad[i % grad.size()] += part[i];
  return grad;
}

/// Layer 1's weight is [state | embeddings]; the roll-out knows the first part, a dense layer the
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

void set_rollout_gradients(const RolloutReferenceGradients& grad, FlatParameters& p) {
  p.set("dynamics.2.weight", grad.weights.w2), p.set("dynamics.2.bias", grad.weights.b2);
  p.set("dynamics.4.weight", grad.weights.w3), p.set("dynamics.4.bias", grad.weights.b3);
}

std::vector<EncoderTrace> encode_all(const ModelSpec& spec, const FlatParameters& p,
                                     const ModelProblem& problem) {
  std::vector<EncoderTrace> encoders;
  const auto add = [&](const char* name, const TactileEncoderShape& shape,
                       const std::vector<int>& last_frame, const TaxelDropout& dropout) {
    encoders.push_back(encode_reference(
        name, shape, spec.embedding, p,
        tactile_window_reference(shape.windows, problem.stream, last_frame, dropout)));
  };
  if (spec.touch)
    add("tactile", window_encoder(spec, problem.sequences * problem.steps), problem.last_frame,
        problem.dropout);
  if (spec.object == ObjectEncoder::joint)
    add("object", segment_encoder(spec, problem.sequences), problem.segment_last_frame,
        problem.segment_dropout);
  return encoders;
}

/// The contrastive loss of the object embeddings; its gradient is added to theirs.
double contrast(const ModelSpec& spec, const ModelProblem& problem, const EncoderTrace& encoder,
                Values& grad_embedding) {
  const auto result =
      info_nce_reference({spec.embedding, spec.contrast_temperature, encoder.embedding,
                          problem.object, problem.contrast_weight});
  for (std::size_t i = 0; i < grad_embedding.size(); ++i)
    grad_embedding[i] += result.grad_embedding[i];
  return std::accumulate(result.row_loss.begin(), result.row_loss.end(), 0.0);
}

}  // namespace

LossAndGradient model_reference(const ModelSpec& spec, const ParameterTable& table,
                                const Values& parameters, const ModelProblem& problem) {
  FlatParameters p{table, parameters, Values(table.size(), 0.0)};
  const int rows = problem.sequences * problem.steps;
  const auto encoders = encode_all(spec, p, problem);
  const FirstLayer layer{spec.state, int(encoders.size()) * spec.embedding, spec.hidden};
  const RolloutShape shape{problem.sequences, problem.steps,    spec.state,
                           spec.hidden,       encoders.empty(), spec.activation};
  const auto w1 = p["dynamics.0.weight"];
  const RolloutWeights weights{layer.state_part(w1), p["dynamics.2.weight"], p["dynamics.2.bias"],
                               p["dynamics.4.weight"], p["dynamics.4.bias"]};
  const auto embeddings = joined_embeddings(encoders, rows, spec.embedding);
  const auto first = encoders.empty()
                         ? p["dynamics.0.bias"]
                         : dense_reference(layer.hoisted(rows), embeddings,
                                           layer.embedding_part(w1), p["dynamics.0.bias"]);
  const auto trace = rollout_reference(shape, problem.initial, first, weights);
  Values grad_state, grad_spread;
  double loss = state_loss(problem, spec, trace, grad_state, grad_spread);
  const auto grad = rollout_backward_reference(shape, trace, weights, grad_state, grad_spread);
  const double distance = kink_distance(spec, problem, encoders, trace);
  set_rollout_gradients(grad, p);
  if (encoders.empty()) {
    p.set("dynamics.0.weight", grad.weights.w1), p.set("dynamics.0.bias", grad.first);
    return {loss, p.gradient, distance};
  }
  const auto hoisted = dense_backward_reference(layer.hoisted(rows), embeddings,
                                                layer.embedding_part(w1), grad.first);
  p.set("dynamics.0.weight", layer.joined(grad.weights.w1, hoisted.weight));
  p.set("dynamics.0.bias", hoisted.bias);
  for (int i = 0; i < int(encoders.size()); ++i) {
    auto towards = embedding_gradient(hoisted.in, encoders[i], layer.embedding, spec.embedding, i);
    if (encoders[i].name == "object") loss += contrast(spec, problem, encoders[i], towards);
    encode_backward_reference(encoders[i], towards, p);
  }
  return {loss, p.gradient, distance};
}

}  // namespace touchtrace
