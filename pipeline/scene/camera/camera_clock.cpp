#include "pipeline/scene/camera/camera_clock.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"

namespace touchtrace::scene {
namespace {

constexpr double max_wait_share = 0.9;  // of a period, so that frames arrive in order

}  // namespace

double CameraClock::arrival_s(std::uint64_t sequence) const {
  const double unit = RandomStream(seed, "camera latency").uniform_at(sequence);
  const double wait_s = std::min(-jitter_s * std::log1p(-unit), max_wait_share * period_s);
  return true_time_s(sequence) + latency_s + wait_s;
}

bool CameraClock::is_dropped(std::uint64_t sequence) const {
  return RandomStream(seed, "camera drops").uniform_at(sequence) < drop_share;
}

std::vector<std::uint64_t> CameraClock::frames_between(double start_s, double end_s) const {
  const double first = (offset_s + (1.0 + drift) * start_s) / period_s;
  std::vector<std::uint64_t> frames;
  for (auto i = static_cast<std::uint64_t>(std::ceil(first)); true_time_s(i) < end_s; ++i)
    if (!is_dropped(i)) frames.push_back(i);
  return frames;
}

CameraClock make_camera_clock(const SceneOptions& options) {
  const CameraParameters& p = options.parameters.camera;
  RandomStream random(options.seed, "camera clock");
  CameraClock clock;
  clock.offset_s = random.uniform(5.0, 50.0);
  clock.drift = random.normal(0.0, 1e-6 * p.clock_ppm);
  clock.latency_s = clock.period_s * random.uniform(p.latency_periods[0], p.latency_periods[1]);
  clock.jitter_s = p.jitter_s, clock.drop_share = p.dropped_fraction;
  clock.seed = options.seed;
  return clock;
}

nlohmann::json clock_truth(const CameraClock& clock) {
  return {{"period_s", clock.period_s},     {"offset_s", clock.offset_s},
          {"drift_ppm", clock.drift * 1e6}, {"latency_s", clock.latency_s},
          {"jitter_s", clock.jitter_s},     {"drop_share", clock.drop_share}};
}

}  // namespace touchtrace::scene
