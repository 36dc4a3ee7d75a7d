#include "engine/train/trial.h"

#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/cl/launch_inspection.h"
#include "engine/cl/timing.h"

namespace touchtrace {

Trial make_trial(Runtime& runtime, std::function<void()> enqueue, int concurrency) {
  if (runtime.device().type != "cpu") return {std::move(enqueue), 1.0};
  const double cores = runtime.device().compute_units;
  double operations = 0.0, with_idle_cores = 0.0;
  visit_launches(runtime, enqueue, [&](const Launch& launch) {
    const auto items = static_cast<double>(launch.items()) * concurrency;
    const double flops = launch.cost().flops;
    operations += flops;
    with_idle_cores += flops * std::ceil(items / cores) * cores / items;
  });
  return {std::move(enqueue), operations > 0.0 ? with_idle_cores / operations : 1.0};
}

std::optional<Trial> make_if_supported(bool is_first,
                                       const std::function<std::optional<Trial>()>& make) {
  try {
    return make();
  } catch (const Error& error) {
    if (is_first || error.code() != ExitCode::no_device) throw;
    return std::nullopt;
  }
}

std::vector<TrialTime> compare(Runtime& runtime, const std::vector<Trial>& trials) {
  std::vector<std::function<void()>> enqueues;
  for (const auto& trial : trials) enqueues.push_back(trial.enqueue);
  const auto rounds = interleaved_seconds(runtime, enqueues);
  std::vector<TrialTime> times;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    std::vector<double> seconds, ratios;
    for (const auto& round : rounds) {
      seconds.push_back(round[i] * trials[i].idle_factor);
      ratios.push_back(seconds.back() / (round[0] * trials[0].idle_factor));
    }
    times.push_back({1e3 * median(seconds), median(ratios)});
  }
  return times;
}

}  // namespace touchtrace
