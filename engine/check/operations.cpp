#include "engine/check/operation.h"
#include "engine/check/rows.h"

namespace touchtrace {

const std::vector<Operation>& operations() {
  static const std::vector<Operation> table{
      tactile_window_operation(), conv2d_operation(),  winograd_operation(),
      channel_blocks_operation(), dense_operation(),   layer_norm_operation(),
      info_nce_operation(),       rollout_operation(), gru_rollout_operation(),
      state_loss_operation(),     sum_operation(),     adam_operation(),
  };
  return table;
}

}  // namespace touchtrace
