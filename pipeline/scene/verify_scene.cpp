#include "pipeline/scene/verify_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <ctime>

#include "pipeline/scene/laboratory.h"
#include "pipeline/scene/statistics.h"

namespace touchtrace::scene {
namespace {

using Emit = std::function<void(Figure)>;

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Run {
  std::vector<ClipMotion> clips;
  double real_time_factor = 0.0;
  GloveClock clock;
};

Run perform(const std::string& activity, const ObjectSpec& object, int clips, double clip_s) {
  SceneOptions options;
  options.clip_s = clip_s;
  options.activity = activity;
  options.object = object;
  Run run;
  run.clock = glove_clock(options);
  const double start = cpu_s();
  double simulated_s = 0.0;
  for (int clip = 0; clip < clips; ++clip) {
    run.clips.push_back(simulate_clip(options, clip, clip * (options.clip_s + options.pause_s)));
    simulated_s += static_cast<double>(run.clips.back().samples.size()) / sample_rate_hz;
  }
  run.real_time_factor = simulated_s / (cpu_s() - start);
  return run;
}

void verify_physics(const Emit& emit) {
  emit(at_most("free flight: position error after 1 s", free_flight_error_m(0.002), "m", 1e-9));
  for (double mass_kg : {0.005, 0.17, 1.0})
    emit(within(fmt::format("block of {} kg at rest: force / weight", mass_kg),
                resting_force_ratio(mass_kg, 0.001, 3.0), "", 0.999, 1.001));
}

void verify_clips(const std::string& activity, const ObjectSpec& object, const Emit& emit) {
  const Run run = perform(activity, object, 20, 10.0);
  const ClipStatistics s = statistics(run.clips, object);
  const std::string what = activity + " " + object.name + ": ";
  emit(at_least(what + "real time on one core", run.real_time_factor, "x", 60.0));
  emit(at_most(what + "clips dropped", s.drop_share, "", 0.05));
  emit(at_most(what + "force against m (a - g), relative rms", s.force_residual, "", 1e-3));
  emit(at_most(what + "99th percentile of grip", s.grip_p99_n, "N", 60.0));
  emit(at_most(what + "saturated readings", s.saturated_share, "", 0.01));
  const Run grasps = perform(activity, object, 64, 3.0);
  const Eigen::Vector3d probe = position_probe_r2(grasps.clips, grasps.clock);
  emit(at_most(what + "place by a linear probe, R^2", probe.head<2>().maxCoeff(), "", 0.1));
  // A tossed object's phase, which touch is there to tell, goes with the height of the hand.
  const std::string height = what + "height by a linear probe, R^2";
  emit(activity == "throw" ? reported(height, probe.z(), "") : at_most(height, probe.z(), "", 0.1));
  if (activity != "throw") return;
  const auto [low, high] = std::ranges::minmax(s.apex_m);
  emit(within(what + "lowest toss", low, "m", 0.07, 0.42));
  emit(within(what + "highest toss", high, "m", 0.10, 0.45));
}

}  // namespace

Verification verify_scene() {
  return [](const Emit& emit) {
    for (const std::string& activity : activity_names()) verify_rendering(activity, emit);
    verify_physics(emit);
    for (const ObjectSpec& object : objects()) verify_clips("wave", object, emit);
    verify_clips("throw", find_object("ball"), emit);
  };
}

}  // namespace touchtrace::scene
