#pragma once

#include <functional>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// Seconds of device time that one call of `enqueue` costs, everything it queued included: the
/// median of `repeats` measurements of at least 20 ms each, after one call that is not measured. On
/// a CPU these are processor seconds of all threads, so that a busy machine does not show; else
/// wall time.
double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats = 7);

/// The same of several, in turns, so that a clock or a neighbour that changes meanwhile meets all
/// of them: [turn][which].
std::vector<std::vector<double>> seconds_in_turns(
    Runtime& runtime, const std::vector<std::function<void()>>& enqueues, int turns = 9);

double median_of(std::vector<double> values);

/// Floating-point operations a second that the device reaches when it does nothing but fused
/// multiply-adds; per processor second on a CPU. Of kernels/fma_peak.cl.
double peak_flops(Runtime& runtime);

/// Floating-point operations that the device could have done at its peak in the time of one call of
/// `enqueue`. Call and peak are measured in turns, so that a clock or a neighbour that changes
/// meanwhile does not show: the median of the turns.
double operations_at_peak(Runtime& runtime, const std::function<void()>& enqueue, int turns = 9);

}  // namespace touchtrace
