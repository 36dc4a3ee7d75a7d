#pragma once

#include <functional>
#include <vector>

#include "engine/cl/launch.h"

namespace touchtrace {

/// The clock of device time: of the processor seconds of all threads on a CPU, so that a busy
/// machine does not show; else of wall time.
double device_clock_s(const Runtime& runtime);

/// Device time of a call, which queues any number of launches. Constructing it does the call
/// several times unmeasured.
class TimedCall {
 public:
  /// Measurements take at least `shortest_s`, with as many calls as that needs.
  TimedCall(Runtime& runtime, std::function<void()> enqueue, double shortest_s = 0.02);
  /// Of one call, from one measurement.
  double seconds() const;

 private:
  double seconds_of(int calls) const;

  Runtime& runtime_;
  std::function<void()> enqueue_;
  int calls_ = 1;
};

/// Seconds of device time that one call of `enqueue` costs, everything it queued included: the
/// median of `repeats` measurements.
double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats = 7);

/// The same of several, in turns, so that a clock or a neighbour that changes meanwhile meets all
/// of them: [turn][which].
std::vector<std::vector<double>> seconds_in_turns(
    Runtime& runtime, const std::vector<std::function<void()>>& enqueues, int turns = 9);

double median_of(std::vector<double> values);

/// Fused multiply-adds on registers alone, as many as keep all of a device busy. Of
/// kernels/fma_peak.cl.
struct PeakWork {
  Launch launch;
  double flops;
};

PeakWork peak_work(Runtime& runtime);

/// Floating-point operations a second that the device reaches when it does nothing but peak_work();
/// per processor second on a CPU.
double peak_flops(Runtime& runtime);

/// Floating-point operations that the device could have done at its peak in the time of one call of
/// `enqueue`. Call and peak are measured in turns, so that a clock or a neighbour that changes
/// meanwhile does not show: the median of the turns.
double operations_at_peak(Runtime& runtime, const std::function<void()>& enqueue, int turns = 9);

}  // namespace touchtrace
