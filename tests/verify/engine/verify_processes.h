#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::cli {

/// Figures of the engine that need processes of their own: start to first training step with
/// programs cached and not, and the same bits on one thread and on two. They run other areas of
/// `touchtrace-verify`.
void verify_processes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace::cli
