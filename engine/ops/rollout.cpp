#include "engine/ops/rollout.h"

namespace touchtrace {
namespace {

cl::Kernel rollout_kernel(Runtime& runtime, const char* name, const RolloutArrays& a) {
  return runtime.kernel(
      {"common.clh", "tile.clh", "dynamics.clh", "rollout.cl", "rollout_backward.cl"}, name,
      {{"HIDDEN", std::to_string(a.hidden)}, {"STATE", std::to_string(a.state)}});
}

/// Four sequences a work-item.
cl::NDRange tiles(int sequences) { return range((sequences + 3) / 4); }

}  // namespace

Launch rollout(Runtime& runtime, const RolloutArrays& a) {
  return Launch(rollout_kernel(runtime, "rollout", a), tiles(a.sequences), a.states, a.first.buffer,
                a.first.at, a.first.row, a.parameters, a.b2_at, a.w1, a.w2, a.w3, a.b3, a.h1, a.h2,
                a.spread, a.sequences, a.steps);
}

Launch rollout_backward(Runtime& runtime, const RolloutArrays& a, const RolloutGradients& g) {
  return Launch(rollout_kernel(runtime, "rollout_backward", a), tiles(a.sequences), g.grad_state,
                g.grad_spread, a.spread, a.h1, a.h2, a.parameters, a.w2_at, a.w3_at, g.w1, g.d_out,
                g.d_h1, g.d_h2, a.sequences, a.steps);
}

}  // namespace touchtrace
