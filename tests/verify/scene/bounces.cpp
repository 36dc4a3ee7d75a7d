#include "tests/verify/scene/bounces.h"

#include <algorithm>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

std::vector<std::size_t> samples_before_impacts(const ClipMotion& clip) {
  std::vector<std::size_t> result;
  const double start_s = clip.samples.front().time_s;
  for (const Truth::Event& event : clip.events)
    if (event.kind == "impact")
      result.push_back(static_cast<std::size_t>((event.time_s - start_s) * sample_rate_hz));
  return result;
}

/// State of the face's centre.
RigidState face_of(const ObjectSpec& object, const SceneSample& sample) {
  ObjectSpec without_ball = object;
  without_ball.tracked_m = object.ball->face_center_m;
  SceneSample held = sample;
  held.ball.reset();
  return tracked_state(without_ball, held);
}

/// Whether the face decelerates over the last 10 ms.
bool is_braking(const ObjectSpec& object, const ClipMotion& clip, std::size_t sample) {
  const std::size_t before = sample - std::min<std::size_t>(sample, 5);
  const auto rise = [&](std::size_t i) {
    return face_of(object, clip.samples[i]).velocity_m_per_s.z();
  };
  return rise(sample) < rise(before);
}

double aside_m(const ObjectSpec& object, const SceneSample& sample) {
  const Vector3d offset = sample.ball->position_m - face_of(object, sample).position_m;
  const Vector3d normal = sample.object.orientation * object.hold.from_palm;
  return (offset - normal * normal.dot(offset)).norm();
}

double rise_m(const ClipMotion& clip, std::size_t from, std::size_t to) {
  double highest = -1e9;
  for (std::size_t i = from; i <= to; ++i)
    highest = std::max(highest, clip.samples[i].ball->position_m.z());
  return highest - clip.samples[from].ball->position_m.z();
}

}  // namespace

BounceStatistics bounce_statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  BounceStatistics s;
  double seconds = 0.0, braking = 0.0;
  for (const ClipMotion& clip : clips) {
    const auto impacts = samples_before_impacts(clip);
    seconds += static_cast<double>(clip.samples.size()) / sample_rate_hz;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
      braking += is_braking(object, clip, impacts[i]);
      s.aside_m.push_back(aside_m(object, clip.samples[impacts[i]]));
      if (i > 0) s.apex_m.push_back(rise_m(clip, impacts[i - 1], impacts[i]));
    }
  }
  const auto count = static_cast<double>(s.aside_m.size());
  s.rate_hz = count / seconds;
  s.braking_share = braking / count;
  return s;
}

}  // namespace touchtrace::scene
