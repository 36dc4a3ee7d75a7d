#include "engine/ops/gru_rollout.h"

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

Kernel gru_kernel(Runtime& runtime, const char* name, const GruArrays& a) {
  return runtime.kernel({"common.clh", "cpu_tile.clh", "dynamics.clh", "rollout_output.clh",
                         "gru_rollout.cl", "gru_rollout_backward.cl"},
                        name,
                        {{"HIDDEN", std::to_string(a.hidden)}, {"STATE", std::to_string(a.state)}});
}

/// Four sequences per work-item.
cl::NDRange gru_tiles(int sequences) { return range(ceil_div(sequences, 4)); }

/// Cost of one pass: products with w, u and the padded w3. Weights are read once.
LaunchCost gru_cost(const GruArrays& a) {
  const double rows = 1.0 * a.sequences * a.steps,
               weights = a.hidden * (3.0 * (a.state + a.hidden) + 2.0 * state_lanes);
  return {2.0 * rows * weights, 4.0 * (weights + rows * (9.0 * a.hidden + 4.0 * state_lanes))};
}

}  // namespace

Launch gru_rollout(Runtime& runtime, const GruArrays& a) {
  return Launch(gru_kernel(runtime, "gru_rollout", a), gru_tiles(a.sequences), a.states, a.h,
                a.input_projection.buffer, a.input_projection.at, a.input_projection.row, a.w, a.u,
                a.parameters, a.bias_at, a.w3, a.b3, a.gates, a.spread, a.sequences, a.steps)
      .with_cost(gru_cost(a))
      .with_purpose(Purpose::rollout);
}

Launch gru_rollout_backward(Runtime& runtime, const GruArrays& a, const GruGradients& g) {
  return Launch(gru_kernel(runtime, "gru_rollout_backward", a), gru_tiles(a.sequences),
                g.grad_state, g.grad_spread, a.spread, a.h, a.gates, a.parameters, a.u_at, a.w3_at,
                g.w, g.d_out, g.d_gates, g.d_h, a.sequences, a.steps)
      .with_cost(gru_cost(a))
      .with_purpose(Purpose::rollout);
}

}  // namespace touchtrace
