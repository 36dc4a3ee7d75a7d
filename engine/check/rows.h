#pragma once

#include "engine/check/operation.h"
#include "engine/ops/conv2d.h"

namespace touchtrace {

// Rows of the table of operations, one per *_cases.cpp.
Operation adam_operation();
Operation channel_blocks_operation();
Operation conv2d_operation();
Operation dense_operation();
Operation gru_rollout_operation();
Operation info_nce_operation();
Operation layer_norm_operation();
Operation rollout_operation();
Operation state_loss_operation();
Operation sum_operation();
Operation tactile_window_operation();
Operation winograd_operation();

OperationCase conv2d_case(const Conv2dShape& shape, Conv2dMethod method);

}  // namespace touchtrace
