#include "engine/model/dynamics.h"

#include "engine/model/dynamics_gru.h"
#include "engine/model/dynamics_mlp.h"

namespace touchtrace {

namespace {

/// Rounds up to the next valid offset of a sub-buffer.
std::size_t align_sub_buffer(std::size_t floats) {
  constexpr std::size_t unit = Runtime::sub_buffer_alignment / sizeof(float);
  return (floats + unit - 1) / unit * unit;
}

}  // namespace

Dynamics::Dynamics(Runtime& runtime, int sequences, int steps) {
  const std::size_t spreads = std::size_t(steps) * sequences * state_lanes,
                    states = spreads + std::size_t(sequences) * state_lanes;
  states_and_spread_ = runtime.allocate<float>(align_sub_buffer(states) + spreads);
  states_ = runtime.sub_buffer(states_and_spread_, 0, states);
  spread_ = runtime.sub_buffer(states_and_spread_, align_sub_buffer(states), spreads);
}

void Dynamics::allocate_gradients(Runtime& runtime) {
  grad_state_ = runtime.allocate<float>(spread_.size());
  grad_spread_ = runtime.allocate<float>(spread_.size());
}

void declare_dynamics(const ModelSpec& spec, ParameterTable& table) {
  if (spec.dynamics == DynamicsKind::gru) return DynamicsGru::declare(spec, table);
  DynamicsMlp::declare(spec, table);
}

std::unique_ptr<Dynamics> make_dynamics(Runtime& runtime, const ModelSpec& spec,
                                        const Weights& weights, const Embeddings& embeddings,
                                        int sequences, int steps) {
  if (spec.dynamics == DynamicsKind::gru)
    return std::make_unique<DynamicsGru>(runtime, spec, weights, embeddings, sequences, steps);
  return std::make_unique<DynamicsMlp>(runtime, spec, weights, embeddings, sequences, steps);
}

}  // namespace touchtrace
