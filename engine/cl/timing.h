#pragma once

#include <functional>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// Seconds of device time that one call of `enqueue` costs, everything it queued included: the
/// median of `repeats` measurements of at least 20 ms each, after one call that is not measured. On
/// a CPU these are processor seconds of all threads, so that a busy machine does not show; else
/// wall time.
double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats = 7);

/// Floating-point operations a second that the device reaches when it does nothing but fused
/// multiply-adds; per processor second on a CPU. Of kernels/fma_peak.cl.
double peak_flops(Runtime& runtime);

}  // namespace touchtrace
