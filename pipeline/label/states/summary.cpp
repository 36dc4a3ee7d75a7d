#include "pipeline/label/states/summary.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

nlohmann::json clock_summary(const ClockFit& clock) {
  return {{"offset_s", clock.offset_s},
          {"drift_ppm", clock.drift_ppm()},
          {"drift_sigma_ppm", 1e6 * clock.rate_sigma},
          {"mean_delay_s", clock.mean_delay_s}};
}

nlohmann::json clocks_summary(const Timeline& timeline) {
  nlohmann::json clocks = {
      {"camera", clock_summary(timeline.camera)},
      {"label_time", timeline.glove ? "mid-scan time of the glove frame" : "camera frame"},
      {"unobservable", "minimum latency of each stream, part of its offset"}};
  if (timeline.glove) clocks["glove"] = clock_summary(*timeline.glove);
  return clocks;
}

nlohmann::json noise_summary(const SmoothedTracks& smoothed) {
  return {{"jerk_density_m2_per_s5", smoothed.noise.jerk_density},
          {"measurement_scale", smoothed.noise.measurement_scale},
          {"bandwidth_rad_per_s", smoothed.noise.bandwidth_rad_per_s}};
}

nlohmann::json flights_summary(const SmoothedTracks& smoothed) {
  auto flights = nlohmann::json::array();
  for (std::size_t clip = 0; clip < smoothed.tracks.size(); ++clip)
    for (const auto& flight : smoothed.tracks[clip].flights)
      flights.push_back(
          {{"clip", clip}, {"release_s", flight.release_s}, {"landing_s", flight.landing_s}});
  return flights;
}

nlohmann::json shapes_summary(const SceneModel& scene) {
  nlohmann::json shapes;
  for (const auto& [object, shape] : scene.object_shape) {
    shapes[object] = {{"unevenness_m", shape.unevenness_m},
                      {"centre_sigma_m", shape.centre_sigma_m}};
    if (shape.body) {
      const Eigen::Vector3d half = shape.body->half_extents_m();
      shapes[object]["half_extents_m"] = {half.x(), half.y(), half.z()};
      shapes[object]["edge_radius_m"] = shape.body->radius_m;
      shapes[object]["core"] = shape.body->core == Core::box ? "box" : "cylinder";
    } else {
      shapes[object]["radius_m"] = shape.radius_m;
    }
  }
  return shapes;
}

nlohmann::json problems_summary(const std::vector<ClipFrames>& clips) {
  auto problems = nlohmann::json::array();
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (!clips[i].problem.empty()) problems.push_back({{"clip", i}, {"problem", clips[i].problem}});
  return problems;
}

double flagged_fraction(const LabelledBody& body, std::uint8_t flag) {
  const auto flagged =
      std::ranges::count_if(body.quality, [&](std::uint8_t bits) { return (bits & flag) != 0; });
  return static_cast<double>(flagged) / std::max(1.0, static_cast<double>(body.quality.size()));
}

/// Median over the labels without flags of the RMS over the axes of the position's standard
/// deviation; null if all have flags.
nlohmann::json median_sigma_m(const LabelledBody& body) {
  std::vector<double> sigmas_m;
  for (std::size_t i = 0; i < body.quality.size(); ++i)
    if (body.quality[i] == quality_good)
      sigmas_m.push_back(
          std::sqrt(Eigen::Map<const Eigen::Matrix<double, 6, 6>>(&body.covariance[36 * i])
                        .diagonal()
                        .head<3>()
                        .mean()));
  if (sigmas_m.empty()) return nullptr;
  return median(std::move(sigmas_m));
}

}  // namespace

double lost_fraction(const std::vector<Observation>& observations) {
  return static_cast<double>(std::ranges::count(observations, false, &Observation::found)) /
         std::max(1.0, static_cast<double>(observations.size()));
}

nlohmann::json summarize(const SceneModel& scene, const Timeline& timeline,
                         const std::vector<ClipFrames>& clips, const std::vector<ClipTrack>& tracks,
                         const SmoothedBodies& bodies, const Labels& labels) {
  int tracker_starts = 0;
  for (const auto& track : tracks) tracker_starts += track.tracker_starts;
  return {
      {"hand_lost_share", flagged_fraction(labels.hand, quality_lost)},
      {"object_lost_share", flagged_fraction(labels.object, quality_lost)},
      {"object_follows_share", flagged_fraction(labels.object, quality_follows_hand)},
      {"hand_sigma_m", median_sigma_m(labels.hand)},
      {"object_sigma_m", median_sigma_m(labels.object)},
      {"tracker_restarts", tracker_starts},
      {"problems", problems_summary(clips)},
      {"object_shape", shapes_summary(scene)},
      {"clocks", clocks_summary(timeline)},
      {"noise", {{"hand", noise_summary(bodies.hand)}, {"object", noise_summary(bodies.object)}}},
      {"flights", flights_summary(bodies.object)}};
}

}  // namespace touchtrace::label
