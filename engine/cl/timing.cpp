#include "engine/cl/timing.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace touchtrace {

double device_clock_s(const Runtime& runtime) {
  timespec time{};
  clock_gettime(runtime.device().type == "cpu" ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

TimedCall::TimedCall(Runtime& runtime, std::function<void()> enqueue, double min_duration_s)
    : runtime_(runtime), enqueue_(std::move(enqueue)) {
  seconds_of(1);
  const double once = std::max(seconds_of(1), 1e-6);
  calls_ = std::max(1, static_cast<int>(std::ceil(min_duration_s / once)));
}

double TimedCall::seconds_of(int calls) const {
  const double start = device_clock_s(runtime_);
  for (int call = 0; call < calls; ++call) enqueue_();
  runtime_.finish();
  return (device_clock_s(runtime_) - start) / calls;
}

double TimedCall::seconds() const { return seconds_of(calls_); }

std::vector<std::vector<double>> interleaved_seconds(
    Runtime& runtime, const std::vector<std::function<void()>>& enqueues, int rounds) {
  std::vector<TimedCall> calls;
  for (const auto& enqueue : enqueues) calls.emplace_back(runtime, enqueue);
  std::vector<std::vector<double>> seconds(static_cast<std::size_t>(rounds));
  for (auto& round : seconds)
    for (const auto& call : calls) round.push_back(call.seconds());
  return seconds;
}

double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats) {
  const TimedCall call(runtime, enqueue);
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat) seconds.push_back(call.seconds());
  return median(seconds);
}

PeakBenchmark peak_benchmark(Runtime& runtime) {
  constexpr int iterations = 100000;
  // A compute unit of a CPU runs one work-item at a time, that of a GPU hundreds.
  const int items_per_unit = runtime.device().type == "gpu" ? 512 : 8;
  const int items = items_per_unit * runtime.device().compute_units;
  const auto out = runtime.allocate<float>(static_cast<std::size_t>(items) * 16);
  return {Launch(runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak"), range(items), out, 0.5f,
                 iterations),
          2.0 * 16 * 12 * iterations * items};
}

double peak_flops(Runtime& runtime) {
  const auto peak = peak_benchmark(runtime);
  return peak.flops / median_seconds(runtime, [&] { peak.launch.enqueue(runtime); });
}

double peak_equivalent_flops(Runtime& runtime, const std::function<void()>& enqueue, int rounds) {
  const auto peak = peak_benchmark(runtime);
  std::vector<double> operations;
  for (const auto& round :
       interleaved_seconds(runtime, {enqueue, [&] { peak.launch.enqueue(runtime); }}, rounds))
    operations.push_back(peak.flops / round[1] * round[0]);
  return median(operations);
}

}  // namespace touchtrace
