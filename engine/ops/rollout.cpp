#include "engine/ops/rollout.h"

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

/// Four sequences per work-item on CPUs, per work-group on GPUs.
Launch rollout_launch(Runtime& runtime, const RolloutArrays& a, const std::string& pass,
                      const auto&... arguments) {
  using Files = std::vector<std::string>;
  const bool gpu = uses_gpu_rollout(runtime, 2 * a.hidden);
  const auto files = gpu ? Files{"common.clh",      "dynamics.clh",
                                 "rollout_gpu.clh", "rollout_output_gpu.clh",
                                 "rollout_gpu.cl",  "rollout_gpu_backward.cl"}
                         : Files{"common.clh",         "cpu_tile.clh", "dynamics.clh",
                                 "rollout_output.clh", "rollout.cl",   "rollout_backward.cl"};
  const Defines defines{{"HIDDEN", std::to_string(a.hidden)},
                        {"STATE", std::to_string(a.state)},
                        {"ACTIVATION", kernel_name_of(a.activation)},
                        {"ACTIVATION_LANES", gpu ? "4" : "16"}};
  Launch launch(runtime.kernel(files, (gpu ? "rollout_gpu" : "rollout") + pass, defines),
                range(ceil_div(a.sequences, 4)), arguments...);
  return gpu ? std::move(launch).with_local_size(gpu_rollout_group) : launch;
}

/// Multiply-adds of one step of one sequence: the two hidden layers and the padded output.
double flops_a_row(const RolloutArrays& a) {
  return 2.0 * a.hidden * (a.state + a.hidden + 2 * state_lanes);
}

/// Bytes of the activations of all rows and of the weights.
double bytes_moved(const RolloutArrays& a, double rows) {
  return 4.0 * (rows * (3 * a.hidden + 4 * state_lanes) + flops_a_row(a) / 2.0);
}

}  // namespace

bool uses_gpu_rollout(const Runtime& runtime, int hidden_values) {
  const std::size_t bytes =
      4 * sizeof(float) * (hidden_values + 2 * state_lanes + gpu_rollout_group);
  return runtime.kernel_variant() == KernelVariant::gpu &&
         bytes <= runtime.device().handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
}

Launch rollout(Runtime& runtime, const RolloutArrays& a) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return rollout_launch(runtime, a, "", a.states, a.input_projection.buffer, a.input_projection.at,
                        a.input_projection.row, a.parameters, a.b2_at, a.w1, a.w2, a.w3, a.b3, a.h1,
                        a.h2, sums ? a.pre_activation1 : a.h1, sums ? a.pre_activation2 : a.h2,
                        a.spread, a.sequences, a.steps)
      .with_cost(rows * flops_a_row(a), bytes_moved(a, rows))
      .with_purpose(Purpose::rollout);
}

Launch rollout_backward(Runtime& runtime, const RolloutArrays& a, const RolloutGradients& g) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return rollout_launch(runtime, a, "_backward", g.grad_state, g.grad_spread, a.spread,
                        sums ? a.pre_activation1 : a.h1, sums ? a.pre_activation2 : a.h2,
                        a.parameters, a.w2_at, a.w3_at, g.w1, g.d_out, g.d_h1, g.d_h2, a.sequences,
                        a.steps)
      .with_cost(rows * flops_a_row(a), bytes_moved(a, rows))
      .with_purpose(Purpose::rollout);
}

}  // namespace touchtrace
