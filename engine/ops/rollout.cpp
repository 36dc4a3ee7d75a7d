#include "engine/ops/rollout.h"

namespace touchtrace {
namespace {

Kernel rollout_kernel(Runtime& runtime, const char* name, const RolloutArrays& a) {
  return runtime.kernel({"common.clh", "tile.clh", "dynamics.clh", "rollout_tiles.clh",
                         "rollout.cl", "rollout_backward.cl"},
                        name,
                        {{"HIDDEN", std::to_string(a.hidden)},
                         {"STATE", std::to_string(a.state)},
                         {"ACTIVATION", kernel_name_of(a.activation)}});
}

/// Multiply-adds of one step of one sequence: the two hidden layers and the padded output.
double flops_a_row(const RolloutArrays& a) {
  return 2.0 * a.hidden * (a.state + a.hidden + 2 * state_lanes);
}

/// Of the activations of all rows and, once, the weights.
double bytes_moved(const RolloutArrays& a, double rows) {
  return 4.0 * (rows * (3 * a.hidden + 4 * state_lanes) + flops_a_row(a) / 2.0);
}

/// Four sequences a work-item.
cl::NDRange tiles(int sequences) { return range((sequences + 3) / 4); }

}  // namespace

Launch rollout(Runtime& runtime, const RolloutArrays& a) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return Launch(rollout_kernel(runtime, "rollout", a), tiles(a.sequences), a.states, a.first.buffer,
                a.first.at, a.first.row, a.parameters, a.b2_at, a.w1, a.w2, a.w3, a.b3, a.h1, a.h2,
                sums ? a.sum1 : a.h1, sums ? a.sum2 : a.h2, a.spread, a.sequences, a.steps)
      .costing(rows * flops_a_row(a), bytes_moved(a, rows));
}

Launch rollout_backward(Runtime& runtime, const RolloutArrays& a, const RolloutGradients& g) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return Launch(rollout_kernel(runtime, "rollout_backward", a), tiles(a.sequences), g.grad_state,
                g.grad_spread, a.spread, sums ? a.sum1 : a.h1, sums ? a.sum2 : a.h2, a.parameters,
                a.w2_at, a.w3_at, g.w1, g.d_out, g.d_h1, g.d_h2, a.sequences, a.steps)
      .costing(rows * flops_a_row(a), bytes_moved(a, rows));
}

}  // namespace touchtrace
