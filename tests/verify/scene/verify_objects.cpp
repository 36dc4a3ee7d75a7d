#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <future>
#include <thread>

#include "engine/base/provenance.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/clip.h"
#include "tests/verify/scene/bounces.h"
#include "tests/verify/scene/probe.h"
#include "tests/verify/scene/statistics.h"
#include "tests/verify/scene/verify_scene.h"

namespace touchtrace::scene {
namespace {

using Emit = std::function<void(Figure)>;

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

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
  const double start = thread_cpu_s();
  for (int clip = 0; clip < clips; ++clip) {
    run.clips.push_back(simulate_clip(options, clip, clip_span(options, clip).start_s));
    run.simulated_s += static_cast<double>(run.clips.back().samples.size()) / sample_rate_hz;
  }
  run.cpu_s = thread_cpu_s() - start;
  return run;
}

/// A person holds a heavier thing harder; a strong hand has some 500 N (Mathiowetz 1985).
double hardest_grip_n(const ObjectSpec& object) { return std::max(60.0, 120.0 * object.mass_kg); }

/// Apexes as the person means them, 10 to 45 cm; skilled hits brake (Dijkstra et al. 2004).
void verify_bounces(const std::string& what, const std::vector<ClipMotion>& clips,
                    const ObjectSpec& object, const Emit& emit) {
  const BounceStatistics s = bounce_statistics(clips, object);
  emit(within(what + "hits a second", s.rate_hz, "1/s", 1.5, 3.5));
  emit(at_least(what + "1st percentile of apexes", percentile(s.apex_m, 0.01), "m", 0.09));
  emit(at_most(what + "99th percentile of apexes", percentile(s.apex_m, 0.99), "m", 0.45));
  emit(at_least(what + "hits with the racket braking", s.braking_share, "", 0.5));
  emit(
      reported(what + "hits beside the middle, 95th percentile", percentile(s.aside_m, 0.95), "m"));
}

void verify_object(const std::string& activity, const ObjectSpec& object, const Emit& emit) {
  const Run run = perform(activity, object, object.ball ? 60 : 20, 10.0);
  const ClipStatistics s = statistics(run.clips, object);
  const std::string what = activity + " " + object.name + ": ";
  emit(at_most(what + "clips dropped", s.drop_share, "", 0.05));
  emit(at_least(what + "real time on one core", run.simulated_s / run.cpu_s, "x", 60.0));
  emit(at_most(what + "force against m (a - g), relative rms", s.force_residual, "", 1e-3));
  emit(at_most(what + "99th percentile of grip", s.grip_p99_n, "N", hardest_grip_n(object)));
  emit(at_most(what + "clips pressed beyond the contact's law", s.clamped_clip_share, "", 0.0));
  emit(at_most(what + "saturated readings", s.saturated_share, "", 0.01));
  emit(reported(what + "most turn in the hand, median of clips",
                percentile(s.turn_in_hand_rad, 0.5), "rad"));
  if (object.ball) verify_bounces(what, run.clips, object, emit);
  if (activity != "throw") return;
  emit(at_most(what + "highest toss", std::ranges::max(s.apex_m), "m", 0.45));
  const double tosses = static_cast<double>(s.apex_m.size());
  emit(at_least(what + "tosses a clip", tosses / static_cast<double>(run.clips.size()), "", 3.0));
}

}  // namespace

void verify_objects(const std::string& activity, const Emit& emit) {
  for (const ObjectSpec& object : objects())
    if (find_activity(activity).takes(object)) verify_object(activity, object, emit);
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
  emit(at_least(fmt::format("{} {}: real time, {} cores at work", activity, object.name, cores),
                simulated_s / stopwatch.wall_seconds(), "x", 300.0));
}

/// Whoever feels whether he holds something, or opens his hand, knows where in a toss he is, and so
/// how high. What a frame tells beyond that would be a leak.
void verify_probe_of_tosses(const std::string& what, const Run& run, const Emit& emit) {
  const auto height = [&](Clue clue, std::optional<Clue> beyond = std::nullopt) {
    return position_probe_r2(run.clips, run.clock, clue, beyond).z();
  };
  emit(reported(what + "height by whether anything is touched, R^2", height(Clue::whether_touched),
                ""));
  emit(reported(what + "height by the phase of the toss, R^2", height(Clue::phase), ""));
  emit(at_most(what + "height by a linear probe, beyond the phase, R^2",
               height(Clue::readings, Clue::phase), "", 0.1));
}

/// A foot's pressure tells how a stick leans and where it is pushed, and a hand is where the lean
/// sends it and pushes towards its home.
void verify_probe_of_balance(const std::string& what, const Run& run, const Run& brief,
                             const Emit& emit) {
  const auto place = [](const Run& of, Clue clue, std::optional<Clue> beyond = std::nullopt) {
    return position_probe_r2(of.clips, of.clock, clue, beyond).head<2>().maxCoeff();
  };
  emit(reported(what + "place by the lean, R^2", place(run, Clue::lean), ""));
  emit(at_most(what + "place by a linear probe, beyond the lean, R^2",
               place(run, Clue::readings, Clue::lean), "", 0.1));
  emit(reported(what + "place, in the first 3 s of clips, beyond the lean",
                place(brief, Clue::readings, Clue::lean), ""));
  emit(at_most(what + "place, in the first 3 s of clips, beyond the lean and the push",
               place(brief, Clue::readings, Clue::lean_and_push), "", 0.1));
}

void verify_probe(const std::string& activity, const Emit& emit) {
  const ObjectSpec& object = default_object(activity);
  const std::string what = activity + " " + object.name + ": ";
  const Run run = perform(activity, object, 64, 10.0), brief = perform(activity, object, 64, 3.0);
  const Eigen::Vector3d probe = position_probe_r2(run.clips, run.clock),
                        at_first = position_probe_r2(brief.clips, brief.clock);
  emit(at_most(what + "place by a linear probe, R^2", probe.head<2>().maxCoeff(), "", 0.1));
  emit(at_most(what + "height by a linear probe, R^2", probe.z(), "", 0.1));
  if (activity == "throw") verify_probe_of_tosses(what, run, emit);
  if (activity == "balance") verify_probe_of_balance(what, run, brief, emit);
  emit(reported(what + "place, in the first 3 s of clips", at_first.head<2>().maxCoeff(), ""));
}

}  // namespace touchtrace::scene
