#include "engine/train/update_plan.h"

#include <utility>

#include "engine/base/progress.h"
#include "engine/base/provenance.h"
#include "engine/cl/launch_inspection.h"
#include "engine/cl/timing.h"
#include "engine/train/noise_training.h"

namespace touchtrace {
namespace {

PlannedLaunch planned(const Launch& launch) {
  return {launch.name(), launch.purpose(), launch.cost()};
}

/// Launches of one update.
Launches launches_of(Runtime& runtime, NoiseTraining& training) {
  Launches launches;
  visit_launches(
      runtime, [&] { training.update(); },
      [&](const Launch& launch) { launches.push_back(launch); });
  return launches;
}

/// MeasuredLaunch::seconds_in_place of each launch, [update][launch].
std::vector<std::vector<double>> seconds_in_place(Runtime& runtime, NoiseTraining& training,
                                                  int updates) {
  std::vector<std::vector<double>> seconds(static_cast<std::size_t>(updates));
  for (auto& update : seconds) {
    double last = device_clock_s(runtime);
    visit_launches(
        runtime, [&] { training.update(); },
        [&](const Launch&) {
          const double now = device_clock_s(runtime);
          update.push_back(now - std::exchange(last, now));
        });
  }
  return seconds;
}

/// Calls that are timed interleaved.
class InterleavedTimings {
 public:
  explicit InterleavedTimings(Runtime& runtime) : runtime_(runtime) {}

  void add(std::function<void()> enqueue, double min_duration_s) {
    calls_.emplace_back(runtime_, std::move(enqueue), min_duration_s);
    seconds_.emplace_back();
  }
  void run(int rounds) {
    Progress progress("measuring", calls_.size() * static_cast<std::size_t>(rounds));
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < calls_.size(); ++i) {
        seconds_[i].push_back(calls_[i].seconds());
        progress.advance();
      }
  }
  double median(std::size_t call) const { return touchtrace::median(seconds_[call]); }

 private:
  Runtime& runtime_;
  std::vector<TimedCall> calls_;
  std::vector<std::vector<double>> seconds_;
};

}  // namespace

std::vector<PlannedLaunch> launches_of_update(Runtime& runtime, const ModelSpec& spec,
                                              int sequences, int steps, const LiveTaxels& live) {
  NoiseTraining training(runtime, spec, sequences, steps, live);
  std::vector<PlannedLaunch> launches;
  for (const auto& launch : launches_of(runtime, training)) launches.push_back(planned(launch));
  return launches;
}

MeasuredUpdate measure_update(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const LiveTaxels& live) {
  constexpr int rounds = 7;
  NoiseTraining training(runtime, spec, sequences, steps, live,
                         {.learning_rate = 0.0, .weight_decay = 0.0});
  const auto launches = launches_of(runtime, training);
  const auto peak = peak_benchmark(runtime);
  std::vector<double> wall, cpu;
  InterleavedTimings measured(runtime);
  measured.add([&] { peak.launch.enqueue(runtime); }, 0.02);
  measured.add(
      [&] {
        const Stopwatch stopwatch;
        training.update();
        wall.push_back(stopwatch.wall_seconds());
        cpu.push_back(stopwatch.cpu_seconds());
      },
      0.08);
  for (const auto& launch : launches) measured.add([&] { launch.enqueue(runtime); }, 4e-3);
  measured.run(rounds);
  const auto in_place = seconds_in_place(runtime, training, rounds);
  MeasuredUpdate result{{}, peak.flops / measured.median(0), median(wall), median(cpu)};
  for (std::size_t i = 0; i < launches.size(); ++i) {
    std::vector<double> seconds;
    for (const auto& update : in_place) seconds.push_back(update[i]);
    result.launches.push_back({planned(launches[i]), measured.median(i + 2), median(seconds)});
  }
  return result;
}

}  // namespace touchtrace
