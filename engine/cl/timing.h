#pragma once

#include <functional>
#include <vector>

#include "engine/base/statistics.h"
#include "engine/cl/launch.h"

namespace touchtrace {

/// Clock of device time [s]: CPU seconds of all threads on a CPU device, so that other processes do
/// not count; else wall time.
double device_clock_s(const Runtime& runtime);

/// Measures the device time of a call that enqueues launches. The constructor makes several
/// unmeasured calls.
class TimedCall {
 public:
  /// A measurement repeats the call until it takes about `min_duration_s`.
  TimedCall(Runtime& runtime, std::function<void()> enqueue, double min_duration_s = 0.02);
  /// Seconds per call, from one measurement.
  double seconds() const;

 private:
  double seconds_of(int calls) const;

  Runtime& runtime_;
  std::function<void()> enqueue_;
  int calls_ = 1;
};

/// Device time of one call of `enqueue` [s], including everything it enqueues: median of `repeats`
/// measurements.
double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats = 7);

/// Device times of several calls [round][call], measured in interleaved order, so that changes of
/// the clock rate or of the machine's load affect all of them alike.
std::vector<std::vector<double>> interleaved_seconds(
    Runtime& runtime, const std::vector<std::function<void()>>& enqueues, int rounds = 9);

/// Fused multiply-adds in registers on all of the device's compute units (kernels/fma_peak.cl).
struct PeakBenchmark {
  Launch launch;
  double flops;
};

PeakBenchmark peak_benchmark(Runtime& runtime);

/// Peak throughput of the device [floating-point operations per second; per CPU second on a CPU].
double peak_flops(Runtime& runtime);

/// Floating-point operations that the device could execute at its peak in the time of one call of
/// `enqueue`: median over interleaved measurements of the call and the peak.
double peak_equivalent_flops(Runtime& runtime, const std::function<void()>& enqueue,
                             int rounds = 9);

}  // namespace touchtrace
