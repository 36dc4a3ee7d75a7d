#include "engine/model/dynamics_output.h"

#include <cmath>

namespace touchtrace {

void DynamicsOutput::declare(const ModelSpec& spec, const std::string& name,
                             ParameterTable& table) {
  const Initial initial{0.0, 1.0 / std::sqrt(spec.hidden)};
  table.add(name + ".weight", {2 * spec.state, spec.hidden}, initial);
  table.add(name + ".bias", {2 * spec.state}, initial);
}

DynamicsOutput::DynamicsOutput(Runtime& runtime, const ModelSpec& spec, const Weights& weights,
                               const std::string& name)
    : spec_(spec),
      weights_(weights),
      name_(name),
      weight_(runtime.allocate<float>(std::size_t(spec.hidden) * 2 * state_lanes)),
      bias_(runtime.allocate<float>(2 * state_lanes)) {
  const auto weight = weights.value(name + ".weight"), bias = weights.value(name + ".bias");
  const int state = spec.state;
  for (int half = 0; half < 2; ++half) {  // delta, band
    const int to = half * state_lanes;
    prepare_.push_back(pack(runtime, weight.from_row(half * state).transposed(),
                            {weight_, to, 2 * state_lanes}, spec.hidden, state, state_lanes));
    prepare_.push_back(
        pack(runtime, bias.from_column(half * state), {bias_, to}, 1, state, state_lanes));
  }
}

void DynamicsOutput::plan_backward(Runtime& runtime, const Buffer<float>& grad_output,
                                   const MatrixView& h, int rows) {
  const int state = spec_.state;
  const auto weight = weights_.grad(name_ + ".weight"), bias = weights_.grad(name_ + ".bias");
  for (int half = 0; half < 2; ++half) {
    const auto grad = MatrixView{grad_output, 0, 2 * state_lanes}.from_column(half * state_lanes);
    append(backward_, gemm(runtime, grad.transposed(), h, {}, weight.from_row(half * state), state,
                           spec_.hidden, rows));
    backward_.push_back(column_sums(runtime, grad, bias.from_column(half * state), rows, state));
  }
}

}  // namespace touchtrace
