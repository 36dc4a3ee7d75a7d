#include "pipeline/label/learn/scene_model.h"

#include <algorithm>
#include <cmath>

#include "pipeline/label/observe/split.h"

namespace touchtrace::label {
namespace {

constexpr float finger_m = 0.015f;            // least thickness of a gloved finger
constexpr double min_visible_fraction = 0.5;  // of the disc of an object apart from the hand

/// `noise_at_1m`: standard deviation at 1 m; empty where nothing is at rest in the images.
double noise_ratio(std::optional<double> noise_at_1m, double z_m) {
  return noise_at_1m ? std::max(1.0, *noise_at_1m * z_m * z_m / reference_depth_sigma_m)
                     : shared_noise_ratio;
}

}  // namespace

void SceneModel::split_object(Surface& surface, const std::string& object,
                              const Eigen::Vector3d& hand_m) const {
  const double radius_m = object_shape.at(object).radius_m;
  const double disc = segmenter->disc_pixels(radius_m, hand_m.z());
  split_from_hand(surface, hand_m, radius_m, static_cast<std::size_t>(min_visible_fraction * disc));
}

BodyView SceneModel::view_object(const RgbdFrame& frame, const std::string& object,
                                 const Patch& patch, double reach_m, bool whole_object) const {
  auto around = segmenter->surface_around(frame, patch.centroid_m, reach_m);
  observer->classify(frame, object, around);
  BodyView view{segmenter->depth_origin_m(), patch.points_m, {}};
  view.noise_ratio = noise_ratio(depth_noise_at_1m, patch.centroid_m.z());
  const Body own = objects_with_hand_color.contains(object) ? Body::hand : Body::object;
  const bool gather =
      whole_object && own == Body::object && !objects_with_rest_color.contains(object);
  if (gather) view.surface_points.clear();
  for (const auto& point : around) {
    const Eigen::Vector3f ray = point.position_m - view.origin_m.cast<float>();
    const bool near = (point.position_m.cast<double>() - patch.centroid_m).norm() < reach_m;
    const float thickness_m = point.body == Body::rest ? 0.0f : finger_m;
    if (point.body != own || !near)
      view.free_space_endpoints.push_back(point.position_m + thickness_m * ray.normalized());
    else if (gather)
      view.surface_points.push_back(point.position_m);
  }
  return view;
}

double SceneModel::occluded_fraction(const RgbdFrame& frame, const Eigen::Vector3d& centre_m,
                                     double radius_m) const {
  const auto around = segmenter->surface_around(frame, centre_m, 0.7 * radius_m);
  const auto behind = std::ranges::count_if(around, [&](const SurfacePoint& point) {
    return point.position_m.z() > centre_m.z() + radius_m;
  });
  return around.empty() ? 1.0
                        : 1.0 - static_cast<double>(behind) / static_cast<double>(around.size());
}

}  // namespace touchtrace::label
