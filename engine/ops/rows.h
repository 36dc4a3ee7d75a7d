#pragma once

#include "engine/ops/operation.h"

namespace touchtrace {

// The rows of the table of operations, each from the *_cases.cpp of its own name.
Operation channel_blocks_operation();
Operation conv2d_operation();
Operation tactile_window_operation();

}  // namespace touchtrace
