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

}  // namespace

double median_seconds(Runtime& runtime, const std::function<void()>& enqueue, int repeats) {
  seconds_of(runtime, enqueue, 1);
  const double once = std::max(seconds_of(runtime, enqueue, 1), 1e-6);
  const int turns = std::max(1, static_cast<int>(std::ceil(shortest_s / once)));
  std::vector<double> seconds;
  for (int repeat = 0; repeat < repeats; ++repeat)
    seconds.push_back(seconds_of(runtime, enqueue, turns));
  std::ranges::nth_element(seconds, seconds.begin() + repeats / 2);
  return seconds[static_cast<std::size_t>(repeats / 2)];
}

double peak_flops(Runtime& runtime) {
  constexpr int turns = 100000;
  const int items = 8 * runtime.device().compute_units;
  const auto out = runtime.allocate<float>(static_cast<std::size_t>(items) * 16);
  const Launch launch(runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak"), range(items), out,
                      0.5f, turns);
  const double seconds = median_seconds(runtime, [&] { launch.enqueue(runtime); });
  return 2.0 * 16 * 12 * turns * items / seconds;
}

}  // namespace touchtrace
