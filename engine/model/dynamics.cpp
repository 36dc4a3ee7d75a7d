#include "engine/model/dynamics.h"

#include "engine/model/dynamics_gru.h"
#include "engine/model/dynamics_mlp.h"

namespace touchtrace {

Dynamics::Dynamics(Runtime& runtime, int sequences, int steps)
    : states_(runtime.allocate<float>((std::size_t(steps) + 1) * sequences * state_lanes)),
      spread_(runtime.allocate<float>(std::size_t(steps) * sequences * state_lanes)) {}

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
