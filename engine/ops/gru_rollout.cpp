#include "engine/ops/gru_rollout.h"

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

/// Four sequences per work-item on CPUs, per work-group on GPUs.
Launch gru_launch(Runtime& runtime, const GruArrays& a, bool gpu, const std::string& pass,
                  const auto&... arguments) {
  using Files = std::vector<std::string>;
  const auto files = gpu ? Files{"common.clh",         "dynamics.clh",
                                 "rollout_gpu.clh",    "rollout_output_gpu.clh",
                                 "gru_rollout_gpu.cl", "gru_rollout_gpu_backward.cl"}
                         : Files{"common.clh",         "cpu_tile.clh",   "dynamics.clh",
                                 "rollout_output.clh", "gru_rollout.cl", "gru_rollout_backward.cl"};
  Defines defines{{"HIDDEN", std::to_string(a.hidden)}, {"STATE", std::to_string(a.state)}};
  if (gpu) defines["ACTIVATION_LANES"] = "4";
  Launch launch(runtime.kernel(files, (gpu ? "gru_rollout_gpu" : "gru_rollout") + pass, defines),
                range(ceil_div(a.sequences, 4)), arguments...);
  return gpu ? std::move(launch).with_local_size(gpu_rollout_group) : launch;
}

/// Cost of one pass: products with w, u and the padded w3. Weights are read once.
LaunchCost gru_cost(const GruArrays& a) {
  const double rows = 1.0 * a.sequences * a.steps,
               weights = a.hidden * (3.0 * (a.state + a.hidden) + 2.0 * state_lanes);
  return {2.0 * rows * weights, 4.0 * (weights + rows * (9.0 * a.hidden + 4.0 * state_lanes))};
}

}  // namespace

Launch gru_rollout(Runtime& runtime, const GruArrays& a) {
  return gru_launch(runtime, a, uses_gpu_rollout(runtime, 2 * a.hidden), "", a.states, a.h,
                    a.input_projection.buffer, a.input_projection.at, a.input_projection.row, a.w,
                    a.u, a.parameters, a.bias_at, a.w3, a.b3, a.gates, a.spread, a.sequences,
                    a.steps)
      .with_cost(gru_cost(a))
      .with_purpose(Purpose::rollout);
}

Launch gru_rollout_backward(Runtime& runtime, const GruArrays& a, const GruGradients& g) {
  const auto launch = [&](bool gpu, const auto&... scratch) {
    return gru_launch(runtime, a, gpu, "_backward", g.grad_state, g.grad_spread, a.spread, a.h,
                      a.gates, a.parameters, a.u_at, a.w3_at, g.w, g.d_out, g.d_gates, scratch...,
                      a.sequences, a.steps)
        .with_cost(gru_cost(a))
        .with_purpose(Purpose::rollout);
  };
  const bool gpu = uses_gpu_rollout(runtime, 5 * a.hidden);
  return gpu ? launch(true) : launch(false, g.d_h);
}

}  // namespace touchtrace
