#include "engine/ops/rollout.h"

namespace touchtrace {
namespace {

constexpr std::size_t lanes_group = 256;  // as in rollout_lanes.clh

/// Whether local memory holds what a step hands on, too.
bool on_lanes(const Runtime& runtime, const RolloutArrays& a) {
  const std::size_t bytes = 4 * sizeof(float) * (2 * a.hidden + 2 * state_lanes + lanes_group);
  return runtime.body() == Body::lanes &&
         bytes <= runtime.device().handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
}

/// Four sequences a work-item, or a work-group.
Launch rollout_launch(Runtime& runtime, const RolloutArrays& a, const std::string& pass,
                      const auto&... arguments) {
  using Files = std::vector<std::string>;
  const bool lanes = on_lanes(runtime, a);
  const auto files = lanes ? Files{"common.clh", "dynamics.clh", "rollout_lanes.clh",
                                   "rollout_lanes.cl", "rollout_lanes_backward.cl"}
                           : Files{"common.clh",        "tile.clh",   "dynamics.clh",
                                   "rollout_tiles.clh", "rollout.cl", "rollout_backward.cl"};
  const Defines defines{{"HIDDEN", std::to_string(a.hidden)},
                        {"STATE", std::to_string(a.state)},
                        {"ACTIVATION", kernel_name_of(a.activation)},
                        {"ACTIVATION_LANES", lanes ? "4" : "16"}};
  Launch launch(runtime.kernel(files, (lanes ? "rollout_lanes" : "rollout") + pass, defines),
                range((a.sequences + 3) / 4), arguments...);
  return lanes ? std::move(launch).in_groups_of(lanes_group) : launch;
}

/// Multiply-adds of one step of one sequence: the two hidden layers and the padded output.
double flops_a_row(const RolloutArrays& a) {
  return 2.0 * a.hidden * (a.state + a.hidden + 2 * state_lanes);
}

/// Of the activations of all rows and, once, the weights.
double bytes_moved(const RolloutArrays& a, double rows) {
  return 4.0 * (rows * (3 * a.hidden + 4 * state_lanes) + flops_a_row(a) / 2.0);
}

}  // namespace

Launch rollout(Runtime& runtime, const RolloutArrays& a) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return rollout_launch(runtime, a, "", a.states, a.first.buffer, a.first.at, a.first.row,
                        a.parameters, a.b2_at, a.w1, a.w2, a.w3, a.b3, a.h1, a.h2,
                        sums ? a.sum1 : a.h1, sums ? a.sum2 : a.h2, a.spread, a.sequences, a.steps)
      .costing(rows * flops_a_row(a), bytes_moved(a, rows))
      .serving(Purpose::rollout);
}

Launch rollout_backward(Runtime& runtime, const RolloutArrays& a, const RolloutGradients& g) {
  const double rows = 1.0 * a.sequences * a.steps;
  const bool sums = slope_from_sum(a.activation);
  return rollout_launch(runtime, a, "_backward", g.grad_state, g.grad_spread, a.spread,
                        sums ? a.sum1 : a.h1, sums ? a.sum2 : a.h2, a.parameters, a.w2_at, a.w3_at,
                        g.w1, g.d_out, g.d_h1, g.d_h2, a.sequences, a.steps)
      .costing(rows * flops_a_row(a), bytes_moved(a, rows))
      .serving(Purpose::rollout);
}

}  // namespace touchtrace
