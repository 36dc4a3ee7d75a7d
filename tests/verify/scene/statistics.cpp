#include "tests/verify/scene/statistics.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

bool has_impact(const ClipMotion& clip, double from_s, double to_s) {
  return std::ranges::any_of(clip.events, [&](const Truth::Event& event) {
    return event.kind == "impact" && event.time_s > from_s && event.time_s <= to_s;
  });
}

/// A sample's force is the mean over the interval before it, so it is compared with the change of
/// velocity in that interval. Intervals with an impact of a ball are skipped.
double force_residual(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  double error = 0.0, scale = 0.0;
  for (const ClipMotion& clip : clips)
    for (std::size_t i = 1; i < clip.samples.size(); ++i) {
      const SceneSample &now = clip.samples[i], &before = clip.samples[i - 1];
      if (has_impact(clip, before.time_s, now.time_s)) continue;
      const Vector3d acceleration =
          (now.object.velocity_m_per_s - before.object.velocity_m_per_s) * sample_rate_hz;
      const Vector3d load = object.mass_kg * (acceleration + gravity_m_per_s2 * Vector3d::UnitZ());
      error += (now.contact_force_n - load).squaredNorm();
      scale += load.squaredNorm();
    }
  return std::sqrt(error / scale);
}

void add_apexes(const ClipMotion& clip, std::vector<double>& apex_m) {
  double release_s = -1.0;
  for (const Truth::Event& event : clip.events) {
    if (event.kind == "release") release_s = event.time_s;
    if (event.kind != "catch") continue;
    double lowest = 1e9, highest = -1e9;
    for (const SceneSample& sample : clip.samples) {
      if (sample.time_s < release_s || sample.time_s > event.time_s) continue;
      if (lowest == 1e9) lowest = sample.object.position_m.z();
      highest = std::max(highest, sample.object.position_m.z());
    }
    apex_m.push_back(highest - lowest);
  }
}

/// Largest rotation of the object in the hand since the clip began.
double turn_in_hand_rad(const ClipMotion& clip) {
  const auto in_hand = [](const SceneSample& sample) {
    return sample.hand.orientation.conjugate() * sample.object.orientation;
  };
  double max_rad = 0.0;
  for (const SceneSample& sample : clip.samples)
    max_rad = std::max(max_rad, in_hand(clip.samples.front()).angularDistance(in_hand(sample)));
  return max_rad;
}

}  // namespace

ClipStatistics statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  ClipStatistics s;
  std::vector<double> grip_n;
  double saturated = 0.0, readings = 0.0;
  for (const ClipMotion& clip : clips) {
    s.drop_share += (clip.object_fell ? 1.0 : 0.0) / static_cast<double>(clips.size());
    s.clamped_clip_share += (clip.num_clamped > 0) / static_cast<double>(clips.size());
    add_apexes(clip, s.apex_m);
    if (!clip.object_fell) s.turn_in_hand_rad.push_back(turn_in_hand_rad(clip));
    for (const SceneSample& sample : clip.samples) {
      if (sample.grip_force_n > 0.0) grip_n.push_back(sample.grip_force_n);
      s.lowest_object_m =
          std::min(s.lowest_object_m, sample.object.position_m.z() - sample.hand.position_m.z());
    }
    readings += static_cast<double>(clip.glove.counts.size());
    saturated += static_cast<double>(std::ranges::count(clip.glove.counts, 1023));
  }
  s.grip_p01_n = quantile(grip_n, 0.01);
  s.grip_p99_n = quantile(grip_n, 0.99);
  s.saturated_share = saturated / readings;
  s.force_residual = force_residual(clips, object);
  return s;
}

}  // namespace touchtrace::scene
