#include "engine/ops/state_loss.h"

namespace touchtrace {

Launches state_loss(Runtime& runtime, const StateLossArrays& a) {
  const Defines defines{{"STATE", std::to_string(a.state)}};
  const std::vector<std::string> files{"common.clh", "state_loss.cl"};
  const int rows = a.sequences * a.steps;
  return {Launch(runtime.kernel(files, "state_loss", defines), range(rows), a.states, a.spread,
                 a.target, a.weight, a.sequences, a.row_loss, a.grad_state, a.grad_spread),
          Launch(runtime.kernel(files, "sum", defines), range(1), a.row_loss, rows, a.total)};
}

}  // namespace touchtrace
