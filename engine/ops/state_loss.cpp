#include "engine/ops/state_loss.h"

namespace touchtrace {

Launch state_loss(Runtime& runtime, const StateLossArrays& a) {
  const auto kernel = runtime.kernel({"common.clh", "state_loss.cl"}, "state_loss",
                                     {{"STATE", std::to_string(a.state)}});
  const double values = 16.0 * a.sequences * a.steps;
  return Launch(kernel, range(a.sequences * a.steps), a.states, a.spread, a.target, a.weight,
                a.sequences, a.band_quantile, a.row_loss, a.grad_state, a.grad_spread)
      .with_cost(24.0 * values, 20.0 * values)
      .with_purpose(Purpose::loss);
}

}  // namespace touchtrace
