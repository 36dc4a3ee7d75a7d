#include <fmt/core.h>

#include <algorithm>
#include <future>
#include <thread>

#include "engine/base/provenance.h"
#include "engine/base/statistics.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/verify/scene/bounces.h"
#include "tests/verify/scene/probe.h"
#include "tests/verify/scene/statistics.h"
#include "tests/verify/scene/verify_scene.h"
#include "tests/verify/support/thread_clock.h"

namespace touchtrace::scene {
namespace {

using Emit = std::function<void(Figure)>;

struct Run {
  std::vector<ClipMotion> clips;
  double simulated_s = 0.0, cpu_s = 0.0;
  GloveClock clock;
};

Run perform(const std::string& activity, const ObjectSpec& object, int clips, double clip_s) {
  SceneOptions options;
  options.clip_s = clip_s;
  options.activity = activity;
  options.object = object;
  Run run;
  run.clock = glove_clock(options);
  const double start = thread_cpu_seconds();
  for (int clip = 0; clip < clips; ++clip) {
    run.clips.push_back(simulate_clip(options, clip, clip_span(options, clip).start_s));
    run.simulated_s += static_cast<double>(run.clips.back().samples.size()) / sample_rate_hz;
  }
  run.cpu_s = thread_cpu_seconds() - start;
  return run;
}

/// Plausible grip force: people grip heavier objects harder; a strong hand reaches 500 N
/// (Mathiowetz 1985).
double max_grip_n(const ObjectSpec& object) { return std::max(60.0, 120.0 * object.mass_kg); }

/// Intended heights are 12 to 42 cm; skilled players decelerate at the hit (Dijkstra et al. 2004).
void verify_bounces(const std::string& what, const std::vector<ClipMotion>& clips,
                    const ObjectSpec& object, const Emit& emit) {
  const BounceStatistics s = bounce_statistics(clips, object);
  emit(within(what + "hits per second", s.rate_hz, "1/s", 1.5, 3.5));
  emit(at_least(what + "1st percentile of apexes", quantile(s.apex_m, 0.01), "m", 0.09));
  emit(at_most(what + "99th percentile of apexes", quantile(s.apex_m, 0.99), "m", 0.45));
  emit(at_least(what + "fraction of hits with a decelerating racket", s.braking_share, "", 0.5));
  emit(reported(what + "distance of hits from the centre, 95th percentile",
                quantile(s.aside_m, 0.95), "m"));
}

void verify_object(const std::string& activity, const ObjectSpec& object, const Emit& emit) {
  const Run run = perform(activity, object, object.ball ? 60 : 20, 10.0);
  const ClipStatistics s = statistics(run.clips, object);
  const std::string what = activity + " " + object.name + ": ";
  emit(at_most(what + "fraction of clips with a drop", s.drop_share, "", 0.05));
  emit(at_least(what + "speed relative to real time, one core", run.simulated_s / run.cpu_s, "x",
                60.0));
  emit(at_most(what + "force against m (a - g), relative rms", s.force_residual, "", 1e-3));
  emit(at_most(what + "99th percentile of grip", s.grip_p99_n, "N", max_grip_n(object)));
  emit(at_most(what + "fraction of clips with too deep contacts", s.clamped_clip_share, "", 0.0));
  emit(at_most(what + "fraction of saturated readings", s.saturated_share, "", 0.01));
  emit(reported(what + "largest rotation in the hand, median of clips",
                quantile(s.turn_in_hand_rad, 0.5), "rad"));
  if (object.ball) verify_bounces(what, run.clips, object, emit);
  if (activity != "throw") return;
  emit(at_most(what + "highest toss", std::ranges::max(s.apex_m), "m", 0.45));
  const double tosses = static_cast<double>(s.apex_m.size());
  emit(at_least(what + "tosses per clip", tosses / static_cast<double>(run.clips.size()), "", 3.0));
}

}  // namespace

void verify_objects(const std::string& activity, const Emit& emit) {
  for (const ObjectSpec& object : objects())
    if (find_activity(activity).accepts(object)) verify_object(activity, object, emit);
}

void verify_speed(const std::string& activity, const Emit& emit) {
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const ObjectSpec& object = default_object(activity);
  const Stopwatch stopwatch;
  std::vector<std::future<Run>> runs;
  for (unsigned core = 0; core < cores; ++core)
    runs.push_back(std::async(std::launch::async, perform, activity, object, 20, 10.0));
  double simulated_s = 0.0;
  for (auto& run : runs) simulated_s += run.get().simulated_s;
  emit(at_least(
      fmt::format("{} {}: speed relative to real time, {} cores", activity, object.name, cores),
      simulated_s / stopwatch.wall_seconds(), "x", 300.0));
}

/// Touch tells the phase of a toss (contact, opening of the hand), and with it the height. What a
/// frame tells beyond the phase would be an artefact.
void verify_probe_of_tosses(const std::string& what, const Run& run, const Emit& emit) {
  const auto height = [&](ProbeInput input, std::optional<ProbeInput> given = std::nullopt) {
    return position_probe_r2(run.clips, run.clock, input, given).z();
  };
  emit(reported(what + "height from contact, R^2", height(ProbeInput::contact), ""));
  emit(reported(what + "height from the phase of the toss, R^2", height(ProbeInput::phase), ""));
  emit(at_most(what + "height from one tactile frame, beyond the phase, R^2",
               height(ProbeInput::readings, ProbeInput::phase), "", 0.1));
}

/// The pressure under the foot tells lean and force, which are correlated with the hand's position:
/// the hand goes where the lean sends it and pushes towards its rest position.
void verify_probe_of_balance(const std::string& what, const Run& run, const Run& brief,
                             const Emit& emit) {
  const auto place = [](const Run& of, ProbeInput input,
                        std::optional<ProbeInput> given = std::nullopt) {
    return position_probe_r2(of.clips, of.clock, input, given).head<2>().maxCoeff();
  };
  emit(reported(what + "position from the lean, R^2", place(run, ProbeInput::lean), ""));
  emit(at_most(what + "position from one tactile frame, beyond the lean, R^2",
               place(run, ProbeInput::readings, ProbeInput::lean), "", 0.1));
  emit(reported(what + "position, first 3 s of clips, beyond the lean, R^2",
                place(brief, ProbeInput::readings, ProbeInput::lean), ""));
  emit(at_most(what + "position, first 3 s of clips, beyond lean and force, R^2",
               place(brief, ProbeInput::readings, ProbeInput::lean_and_force), "", 0.1));
}

void verify_probe(const std::string& activity, const Emit& emit) {
  const ObjectSpec& object = default_object(activity);
  const std::string what = activity + " " + object.name + ": ";
  const Run run = perform(activity, object, 64, 10.0), brief = perform(activity, object, 64, 3.0);
  const Eigen::Vector3d probe = position_probe_r2(run.clips, run.clock),
                        at_first = position_probe_r2(brief.clips, brief.clock);
  emit(at_most(what + "position from one tactile frame, R^2", probe.head<2>().maxCoeff(), "", 0.1));
  emit(at_most(what + "height from one tactile frame, R^2", probe.z(), "", 0.1));
  if (activity == "throw") verify_probe_of_tosses(what, run, emit);
  if (activity == "balance") verify_probe_of_balance(what, run, brief, emit);
  emit(reported(what + "position, first 3 s of clips, R^2", at_first.head<2>().maxCoeff(), ""));
}

}  // namespace touchtrace::scene
