#include "pipeline/scene/simulate/clip.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "pipeline/scene/glove/glove.h"
#include "pipeline/scene/glove/inertial.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/person/person_simulation.h"
#include "pipeline/scene/simulate/oracle.h"

namespace touchtrace::scene {
namespace {

constexpr double first_clip_s = 1.0;
constexpr double min_flight_s = 0.04;

double whole_intervals_s(double time_s) {
  return std::round(time_s * sample_rate_hz) / sample_rate_hz;
}

/// Adds a release and a catch for every time without contact of at least min_flight_s.
void add_flights(ClipMotion& clip) {
  double last_touch_s = clip.samples.empty() ? 0.0 : clip.samples.front().time_s;
  for (const SceneSample& sample : clip.samples) {
    if (sample.contact_force_n.isZero(0.0)) continue;
    if (sample.time_s - last_touch_s > min_flight_s) {
      clip.events.push_back({last_touch_s, "release"});
      clip.events.push_back({sample.time_s, "catch"});
    }
    last_touch_s = sample.time_s;
  }
}

/// Adds the impacts of the ball in the last control interval.
void add_impacts(const World& world, double interval_start_s, ClipMotion& clip) {
  constexpr double min_approach_m_per_s = 0.1;  // slower impacts are of a rolling ball
  for (const World::TimedImpact& impact : world.impacts())
    if (impact.approach_m_per_s > min_approach_m_per_s)
      clip.events.push_back({interval_start_s + impact.after_s, "impact"});
}

/// Records one clip after the grasp. `start_s` on the host clock is time 0 of the activity.
ClipMotion record(PersonSimulation& simulation, double start_s, double length_s) {
  ClipMotion clip;
  const int samples = static_cast<int>(std::lround(length_s * sample_rate_hz));
  clip.samples.reserve(samples);
  const long clamped_before = simulation.world().contact().num_clamped();
  Glove& glove = simulation.glove();
  glove.start(start_s);
  for (int i = 0; i < samples; ++i) {
    SceneSample sample = simulation.sample();
    sample.time_s = start_s + i * control_interval_s;
    clip.samples.push_back(sample);
    if (simulation.is_lost()) {
      clip.object_fell = true;
      clip.events.push_back({sample.time_s, "drop"});
      break;
    }
    simulation.advance();
    add_impacts(simulation.world(), sample.time_s, clip);
  }
  clip.glove = glove.take();
  clip.num_clamped = simulation.world().contact().num_clamped() - clamped_before;
  add_flights(clip);
  return clip;
}

}  // namespace

ClipSpan clip_span(const SceneOptions& options, int clip) {
  const double apart_s = options.clip_s * (1 + options.clip_spread) + options.pause_s;
  RandomStream random(options.seed, fmt::format("clip {} length", clip));
  const double share = random.uniform(1 - options.clip_spread, 1 + options.clip_spread);
  return {whole_intervals_s(first_clip_s + clip * apart_s),
          whole_intervals_s(share * options.clip_s)};
}

int clip_count(const SceneOptions& options) {
  return std::max(1, static_cast<int>(std::lround(60.0 * options.minutes / options.clip_s)));
}

ClipMotion simulate_clip(const SceneOptions& options, int clip, double start_s) {
  for (int attempt = 1;; ++attempt) {
    const std::string name = fmt::format("{} {} clip {} attempt {}", options.activity,
                                         options.object.name, clip, attempt);
    PersonSimulation simulation(options, name, start_s);
    const bool held = simulation.grasp();
    if (!held && attempt < options.parameters.grasp.attempts) continue;
    ClipMotion motion = record(simulation, start_s, clip_span(options, clip).length_s);
    replace_touch(options, motion);
    if (options.inertial_unit) motion.glove.inertial = sense_inertia(motion.samples, options, clip);
    return motion;
  }
}

}  // namespace touchtrace::scene
