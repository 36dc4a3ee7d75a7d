#include "tests/verify/engine/model_reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/check/info_nce_reference.h"
#include "engine/check/state_loss_reference.h"
#include "engine/check/tactile_window_reference.h"
#include "engine/model/tactile_encoder.h"
#include "tests/verify/engine/dynamics_reference.h"
#include "tests/verify/engine/encoder_reference.h"

namespace touchtrace {
namespace {

using Values = std::vector<double>;

/// Returns the state loss and sets its gradients with respect to predicted states and spread.
double state_loss(const ModelProblem& problem, const ModelSpec& spec,
                  const DynamicsReference& dynamics, Values& grad_state, Values& grad_spread) {
  double loss = 0.0;
  const std::size_t first = problem.initial.size();
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double weight = problem.weight[i / spec.state];
    const auto term = state_loss_reference(dynamics.states[first + i], dynamics.spread[i],
                                           problem.target[i], spec.band_quantile);
    loss += weight * term.value;
    grad_state.push_back(weight * term.grad_state);
    grad_spread.push_back(weight * term.grad_spread);
  }
  return loss;
}

double kink_distance(const ModelProblem& problem, const std::vector<EncoderTrace>& encoders,
                     const DynamicsReference& dynamics) {
  double distance = dynamics.kink_distance;
  const auto add = [&](const Values& sums) {
    for (double sum : sums) distance = std::min(distance, std::abs(sum));
  };
  for (const auto& encoder : encoders)
    for (const auto& sums : encoder.sums) add(sums);
  for (std::size_t i = 0; i < problem.target.size(); ++i) {
    const double error = problem.target[i] - dynamics.states[problem.initial.size() + i];
    for (double quantile : {-dynamics.spread[i], 0.0, dynamics.spread[i]})
      distance = std::min(distance, std::abs(error - quantile));
  }
  return distance;
}

/// Inputs of the dynamics in addition to the state: the existing embeddings of each row of [T, S].
Values joined_embeddings(const std::vector<EncoderTrace>& encoders, std::size_t rows, int size) {
  Values joined;
  for (std::size_t row = 0; row < rows; ++row)
    for (const auto& encoder : encoders) {
      const auto own_rows = encoder.embedding.size() / size;  // T S for touch, S for objects
      const auto begin = encoder.embedding.begin() + std::ptrdiff_t(row % own_rows) * size;
      joined.insert(joined.end(), begin, begin + size);
    }
  return joined;
}

/// Gradient with respect to the embedding of encoder `index`, from that with respect to
/// joined_embeddings(), whose rows have `columns` values.
Values embedding_gradient(const Values& joined, const EncoderTrace& encoder, int columns, int size,
                          int index) {
  const auto own = columns_between(joined, columns, index * size, (index + 1) * size);
  Values grad(encoder.embedding.size(), 0.0);
  for (std::size_t i = 0; i < own.size(); ++i) grad[i % grad.size()] += own[i];
  return grad;
}

std::vector<EncoderTrace> encode_all(const ModelSpec& spec, const FlatParameters& p,
                                     const ModelProblem& problem) {
  std::vector<EncoderTrace> encoders;
  const auto add = [&](const char* name, const ConvStackShape& shape,
                       const std::vector<int>& window_end, const TaxelDropout& dropout) {
    encoders.push_back(encode_reference(
        name, shape, spec.embedding, p,
        tactile_window_reference(shape.windows, problem.stream, window_end, dropout)));
  };
  if (spec.touch)
    add("tactile", window_encoder(spec, problem.sequences * problem.steps), problem.window_end,
        problem.dropout);
  if (spec.object == ObjectEncoder::joint)
    add("object", segment_encoder(spec, problem.sequences), problem.segment_end,
        problem.segment_dropout);
  return encoders;
}

/// Returns the contrastive loss of the object embeddings and adds its gradient to theirs.
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
  const auto encoders = encode_all(spec, p, problem);
  const int columns = int(encoders.size()) * spec.embedding;
  const auto dynamics = dynamics_reference(
      spec, p,
      {problem.sequences, problem.steps, problem.initial,
       joined_embeddings(encoders, std::size_t(problem.sequences) * problem.steps, spec.embedding),
       columns});
  Values grad_state, grad_spread;
  double loss = state_loss(problem, spec, dynamics, grad_state, grad_spread);
  const auto grad_embeddings = dynamics.backward(grad_state, grad_spread, p);
  for (int i = 0; i < int(encoders.size()); ++i) {
    auto grad = embedding_gradient(grad_embeddings, encoders[i], columns, spec.embedding, i);
    if (encoders[i].name == "object") loss += contrast(spec, problem, encoders[i], grad);
    encode_backward_reference(encoders[i], grad, p);
  }
  return {loss, p.gradient, kink_distance(problem, encoders, dynamics)};
}

}  // namespace touchtrace
