#include "engine/cl/timing.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "engine/cl/launch.h"

namespace touchtrace {
namespace {

constexpr double shortest_s = 0.02;

double now_s(const Runtime& runtime) {
  timespec time{};
  clock_gettime(runtime.device().type == "cpu" ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds_of(Runtime& runtime, const std::function<void()>& enqueue, int turns) {
  const double start = now_s(runtime);
  for (int turn = 0; turn < turns; ++turn) enqueue();
  runtime.finish();
  return (now_s(runtime) - start) / turns;
}

/// How many calls fill the shortest time worth measuring.
int calls_to_fill(Runtime& runtime, const std::function<void()>& enqueue) {
  seconds_of(runtime, enqueue, 1);
  const double once = std::max(seconds_of(runtime, enqueue, 1), 1e-6);
  return std::max(1, static_cast<int>(std::ceil(shortest_s / once)));
}

/// Multiply-adds on registers alone.
struct Peak {
  Launch launch;
  double flops;
};

Peak make_peak(Runtime& runtime) {
  constexpr int turns = 100000;
  // A CPU's unit runs one work-item at a time, a GPU's hundreds.
  const int items_a_unit = runtime.device().type == "gpu" ? 512 : 8;
  const int items = items_a_unit * runtime.device().compute_units;
  const auto out = runtime.allocate<float>(static_cast<std::size_t>(items) * 16);
  return {Launch(runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak"), range(items), out, 0.5f,
                 turns),
          2.0 * 16 * 12 * turns * items};
}

}  // namespace

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<std::vector<double>> seconds_in_turns(
    Runtime& runtime, const std::vector<std::function<void()>>& enqueues, int turns) {
  std::vector<int> calls;
  for (const auto& enqueue : enqueues) calls.push_back(calls_to_fill(runtime, enqueue));
  std::vector<std::vector<double>> seconds(static_cast<std::size_t>(turns));
  for (auto& turn : seconds)
    for (std::size_t i = 0; i < enqueues.size(); ++i)
      turn.push_back(seconds_of(runtime, enqueues[i], calls[i]));
  return seconds;
}

double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats) {
  const int calls = calls_to_fill(runtime, enqueue);
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat)
    seconds.push_back(seconds_of(runtime, enqueue, calls));
  return median_of(seconds);
}

double peak_flops(Runtime& runtime) {
  const auto peak = make_peak(runtime);
  return peak.flops / median_seconds(runtime, [&] { peak.launch.enqueue(runtime); });
}

double operations_at_peak(Runtime& runtime, const std::function<void()>& enqueue, int turns) {
  const auto peak = make_peak(runtime);
  const auto enqueue_peak = [&] { peak.launch.enqueue(runtime); };
  const int calls = calls_to_fill(runtime, enqueue),
            peak_calls = calls_to_fill(runtime, enqueue_peak);
  std::vector<double> operations;
  for (int turn = 0; turn < turns; ++turn) {
    const double seconds = seconds_of(runtime, enqueue, calls);
    operations.push_back(peak.flops / seconds_of(runtime, enqueue_peak, peak_calls) * seconds);
  }
  return median_of(operations);
}

}  // namespace touchtrace
