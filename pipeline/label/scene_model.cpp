#include "pipeline/label/scene_model.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "pipeline/label/lift.h"

namespace touchtrace::label {
namespace {

constexpr float bin_m = 0.02f, farthest_m = 5.0f, behind_band_m = 0.40f;
constexpr double torso_part = 0.04;  // of the image that a torso covers at least
constexpr std::size_t most_background = 15, frames_per_clip = 8, fewest_points = 12,
                      most_views = 64;
constexpr float finger_m = 0.015f;  // what hides an object is a gloved finger at least so thick
constexpr double cluster_radius_m = 0.12, silhouette_quantile = 0.8, around_radii = 2.5,
                 sensor_noise_m = 0.0015, deviations_of_median = 1.4826;

std::vector<std::uint16_t> background_depth(const FrameSource& frames) {
  std::vector<std::vector<std::uint16_t>> depths;
  for (std::size_t i = 0; i < std::min(most_background, frames.background_frames); ++i)
    depths.push_back(frames.background(i).depth);
  return median_depth(depths);
}

/// Frames spread over a clip, its first among them.
std::vector<std::size_t> sampled_frames(const ClipFrames& clip) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < std::min(frames_per_clip, clip.count); ++i)
    result.push_back(clip.first + i * clip.count / std::min(frames_per_clip, clip.count));
  return result;
}

/// Where the torso begins: from the largest peak of the depths nearer until 10 % of it. Infinite if
/// nothing as large as a torso is there.
float band_limit(const std::vector<double>& histogram, double pixels) {
  const auto peak = std::max_element(histogram.begin(), histogram.end());
  const auto low = std::max(histogram.begin(), peak - 5),
             high = std::min(histogram.end(), peak + 6);
  if (std::accumulate(low, high, 0.0) < torso_part * pixels) return farthest_m;
  auto edge = peak;
  while (edge != histogram.begin() && *edge > 0.1 * *peak) --edge;
  return bin_m * static_cast<float>(edge - histogram.begin() + 1);
}

double quantile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

struct Samples {
  std::map<std::string, std::vector<std::pair<std::size_t, Surface>>>
      surfaces;  ///< by object, with their frames
  std::vector<double> depths =
      std::vector<double>(static_cast<std::size_t>(farthest_m / bin_m) + 1);
  std::size_t frames = 0;
};

/// Sees a few frames of every clip; counts depths and, in first frames, colours.
Samples sample(SceneModel& model, const FrameSource& frames, const std::vector<ClipFrames>& clips) {
  Samples samples;
  for (const auto& clip : clips)
    for (const auto index : sampled_frames(clip)) {
      throw_if_interrupted();
      auto surface = model.segmenter.moving_surface(frames.camera_frame(index));
      for (const auto& point : surface)
        samples
            .depths[static_cast<std::size_t>(std::min(point.position_m.z(), farthest_m) / bin_m)] +=
            1.0;
      if (index == clip.first)
        model.colors[clip.object].learn(surface, clip.hand_box, clip.object_box);
      samples.surfaces[clip.object].emplace_back(index, std::move(surface));
      ++samples.frames;
    }
  return samples;
}

double fit_cost(const std::vector<SphereView>& views, double radius_m) {
  double cost = 0.0;
  for (const auto& view : views) cost += fit_sphere(view, radius_m).cost_m2;
  return cost;
}

/// The radius of the sphere that fits all views best, near that of the silhouette.
double fitted_radius(const std::vector<SphereView>& views, double silhouette_m) {
  double best = silhouette_m, lowest = std::numeric_limits<double>::infinity();
  for (double part = 0.6; part <= 1.4; part += 0.02) {
    const double cost = fit_cost(views, part * silhouette_m);
    if (cost < lowest) lowest = cost, best = part * silhouette_m;
  }
  return best;
}

/// The object in one of the sampled frames.
struct Sighting {
  std::size_t frame;
  Patch patch;
};

std::vector<Sighting> sightings_of(const ColorClasses& colors,
                                   std::vector<std::pair<std::size_t, Surface>>& surfaces) {
  std::vector<Sighting> result;
  for (auto& [frame, surface] : surfaces) {
    colors.assign(surface);
    const auto start = median_point(surface, Body::object, Eigen::Vector3d::Zero(), farthest_m);
    if (!start) continue;
    if (auto patch = find_patch(surface, Body::object, *start, cluster_radius_m, fewest_points))
      result.push_back({frame, std::move(*patch)});
  }
  return result;
}

/// How far the surface is from the sphere, beyond the sensor's own noise: the median distance in
/// terms of a normal deviation.
double unevenness(const std::vector<SphereView>& views, double radius_m) {
  std::vector<double> distances_m;
  for (const auto& view : views) {
    const Eigen::Vector3d center = fit_sphere(view, radius_m).center_m;
    for (const auto& point : view.on_m)
      distances_m.push_back(std::abs((point.cast<double>() - center).norm() - radius_m));
  }
  const double deviation_m = deviations_of_median * quantile(std::move(distances_m), 0.5);
  return std::sqrt(std::max(0.0, deviation_m * deviation_m - sensor_noise_m * sensor_noise_m));
}

/// Through what is seen of the object and beside what is seen past it.
SceneModel::Sphere object_sphere(const SceneModel& model, const FrameSource& frames,
                                 const std::string& object,
                                 const std::vector<Sighting>& sightings) {
  if (sightings.empty())
    throw data_error("the object was not found in any frame by the colours of its box",
                     "give object boxes that lie on the object in each clip's first frame");
  std::vector<double> radii;
  for (const auto& sighting : sightings) radii.push_back(silhouette_radius_m(sighting.patch));
  const double silhouette_m = quantile(std::move(radii), silhouette_quantile);
  std::vector<SphereView> views;
  const std::size_t stride = (sightings.size() + most_views - 1) / most_views;
  for (std::size_t i = 0; i < sightings.size(); i += stride)
    views.push_back(model.view_sphere(frames.camera_frame(sightings[i].frame), object,
                                      sightings[i].patch, silhouette_m));
  const double radius_m = fitted_radius(views, silhouette_m);
  return {radius_m, unevenness(views, radius_m)};
}

}  // namespace

Surface SceneModel::see(const RgbdFrame& frame, const std::string& object) const {
  auto surface = segmenter.moving_surface(frame);
  colors.at(object).assign(surface);
  std::erase_if(surface, [&](const SurfacePoint& point) {
    return point.position_m.z() > band_m + (point.body == Body::rest ? 0.0f : behind_band_m);
  });
  return surface;
}

SphereView SceneModel::view_sphere(const RgbdFrame& frame, const std::string& object,
                                   const Patch& patch, double radius_m) const {
  auto around = segmenter.surface_around(frame, patch.centroid_m, around_radii * radius_m);
  colors.at(object).assign(around);
  SphereView view{segmenter.depth_eye_m(), patch.points_m, {}};
  for (const auto& point : around) {
    if (point.body == Body::object) continue;
    const Eigen::Vector3f ray = point.position_m - view.eye_m.cast<float>();
    view.seen_past_m.push_back(point.position_m + finger_m * ray.normalized());
  }
  return view;
}

double SceneModel::hidden_part(const RgbdFrame& frame, const Eigen::Vector3d& center_m,
                               double radius_m) const {
  const auto around = segmenter.surface_around(frame, center_m, 0.7 * radius_m);
  const auto past = std::ranges::count_if(around, [&](const SurfacePoint& point) {
    return point.position_m.z() > center_m.z() + radius_m;
  });
  return around.empty() ? 1.0
                        : 1.0 - static_cast<double>(past) / static_cast<double>(around.size());
}

SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips) {
  SceneModel model{Segmenter(calibration, camera, background_depth(frames)), 0.0f, {}, {}};
  auto samples = sample(model, frames, clips);
  for (auto& [object, classes] : model.colors) classes.settle();
  model.band_m = band_limit(samples.depths,
                            static_cast<double>(samples.frames) * camera.width * camera.height);
  for (auto& [object, surfaces] : samples.surfaces)
    model.object_sphere[object] =
        object_sphere(model, frames, object, sightings_of(model.colors.at(object), surfaces));
  return model;
}

}  // namespace touchtrace::label
