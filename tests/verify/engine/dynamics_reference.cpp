#include "tests/verify/engine/dynamics_reference.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/check/dense_reference.h"
#include "engine/check/gru_rollout_reference.h"
#include "engine/check/rollout_reference.h"

namespace touchtrace {
namespace {

using Vector = std::vector<double>;

/// Layer with the input [state | embeddings]. The roll-out applies the weight's columns for the
/// state, a dense layer those for the embeddings.
struct InputReference {
  std::string weight, bias;
  int state, outputs;
  DynamicsProblem problem;

  int inputs() const { return state + problem.columns; }
  DenseShape projection_shape() const {
    return {problem.sequences * problem.steps, problem.columns, outputs};
  }
  Vector state_weight(const FlatParameters& p) const {
    return columns_between(p[weight], inputs(), 0, state);
  }
  Vector embedding_weight(const FlatParameters& p) const {
    return columns_between(p[weight], inputs(), state, inputs());
  }
  /// Pre-activations without the contribution of the state; one row for all without embeddings.
  Vector input_projection(const FlatParameters& p) const {
    if (problem.columns == 0) return p[bias];
    return dense_reference(projection_shape(), problem.embeddings, embedding_weight(p), p[bias]);
  }
  /// Sets the parameters' gradients from those with respect to input_projection() and
  /// state_weight(). Returns the gradient with respect to the embeddings.
  Vector backward(const Vector& grad_projection, const Vector& grad_state_weight,
                  FlatParameters& p) const {
    if (problem.columns == 0) {
      p.set(weight, grad_state_weight), p.set(bias, grad_projection);
      return {};
    }
    const auto grad = dense_backward_reference(projection_shape(), problem.embeddings,
                                               embedding_weight(p), grad_projection);
    p.set(weight, join_columns(grad_state_weight, grad.weight)), p.set(bias, grad.bias);
    return grad.in;
  }
  Vector join_columns(const Vector& of_state, const Vector& of_embedding) const {
    Vector w;
    for (int i = 0; i < outputs * inputs(); ++i) {
      const int output = i / inputs(), input = i % inputs();
      w.push_back(input < state ? of_state[output * state + input]
                                : of_embedding[output * problem.columns + input - state]);
    }
    return w;
  }
};

RolloutShape shape_of(const ModelSpec& spec, const DynamicsProblem& problem) {
  return {problem.sequences, problem.steps,        spec.state,
          spec.hidden,       problem.columns == 0, spec.activation};
}

double nearest_kink(const ModelSpec& spec, const RolloutTrace& trace) {
  double distance = 1.0;
  if (!has_kink(spec.activation)) return distance;
  for (const auto* sums : {&trace.pre_activation1, &trace.pre_activation2})
    for (double sum : *sums) distance = std::min(distance, std::abs(sum));
  return distance;
}

DynamicsReference mlp_reference(const ModelSpec& spec, const FlatParameters& p,
                                const DynamicsProblem& problem) {
  const InputReference input{"dynamics.0.weight", "dynamics.0.bias", spec.state, spec.hidden,
                             problem};
  const RolloutWeights weights{input.state_weight(p), p["dynamics.2.weight"], p["dynamics.2.bias"],
                               p["dynamics.4.weight"], p["dynamics.4.bias"]};
  const auto shape = shape_of(spec, problem);
  const auto trace = rollout_reference(shape, problem.initial, input.input_projection(p), weights);
  const auto backward = [=](const Vector& grad_state, const Vector& grad_spread,
                            FlatParameters& to) {
    const auto grad = rollout_backward_reference(shape, trace, weights, grad_state, grad_spread);
    to.set("dynamics.2.weight", grad.weights.w2), to.set("dynamics.2.bias", grad.weights.b2);
    to.set("dynamics.4.weight", grad.weights.w3), to.set("dynamics.4.bias", grad.weights.b3);
    return input.backward(grad.input_projection, grad.weights.w1, to);
  };
  return {trace.states, trace.spread, nearest_kink(spec, trace), backward};
}

DynamicsReference gru_reference(const ModelSpec& spec, const FlatParameters& p,
                                const DynamicsProblem& problem) {
  const std::string cell = "dynamics.cell.", out = "dynamics.out.";
  const InputReference input{cell + "weight_ih", cell + "bias_ih", spec.state, 3 * spec.hidden,
                             problem};
  const GruWeights weights{input.state_weight(p), p[cell + "weight_hh"], p[cell + "bias_hh"],
                           p[out + "weight"], p[out + "bias"]};
  const auto shape = shape_of(spec, problem);
  const Vector hidden(std::size_t(problem.sequences) * spec.hidden, 0.0);
  const auto trace =
      gru_rollout_reference(shape, problem.initial, hidden, input.input_projection(p), weights);
  const auto backward = [=](const Vector& grad_state, const Vector& grad_spread,
                            FlatParameters& to) {
    const auto grad =
        gru_rollout_backward_reference(shape, trace, weights, grad_state, grad_spread);
    to.set(cell + "weight_hh", grad.weights.u), to.set(cell + "bias_hh", grad.weights.bias);
    to.set(out + "weight", grad.weights.w3), to.set(out + "bias", grad.weights.b3);
    return input.backward(grad.input_projection, grad.weights.w, to);
  };
  return {trace.states, trace.spread, 1.0, backward};
}

}  // namespace

std::vector<double> columns_between(const std::vector<double>& matrix, int columns, int begin,
                                    int end) {
  Vector result;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    if (int(i % columns) >= begin && int(i % columns) < end) result.push_back(matrix[i]);
  return result;
}

DynamicsReference dynamics_reference(const ModelSpec& spec, const FlatParameters& parameters,
                                     const DynamicsProblem& problem) {
  return spec.dynamics == DynamicsKind::gru ? gru_reference(spec, parameters, problem)
                                            : mlp_reference(spec, parameters, problem);
}

}  // namespace touchtrace
