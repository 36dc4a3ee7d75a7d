#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Engine figures that need separate processes, which run other areas of `touchtrace-verify`: time
/// from start to first training step with and without cached programs, and bitwise equality on one
/// thread and on two.
void verify_processes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
