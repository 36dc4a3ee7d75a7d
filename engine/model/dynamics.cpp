#include "engine/model/dynamics.h"

#include "engine/base/integer_math.h"
#include "engine/model/dynamics_gru.h"
#include "engine/model/dynamics_mlp.h"

namespace touchtrace {

namespace {

/// The next place where a part of a buffer may begin.
std::size_t next_part_at(std::size_t floats) {
  constexpr std::size_t unit = Runtime::sub_buffer_alignment / sizeof(float);
  return round_up(floats, unit);
}

}  // namespace

Dynamics::Dynamics(Runtime& runtime, int sequences, int steps) {
  const std::size_t spreads = std::size_t(steps) * sequences * state_lanes,
                    states = spreads + std::size_t(sequences) * state_lanes;
  outcome_ = runtime.allocate<float>(next_part_at(states) + spreads);
  states_ = runtime.sub_buffer(outcome_, 0, states);
  spread_ = runtime.sub_buffer(outcome_, next_part_at(states), spreads);
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
