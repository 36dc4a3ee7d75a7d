#include "pipeline/label/scene_model.h"

#include <algorithm>
#include <cmath>

#include "pipeline/label/split.h"

namespace touchtrace::label {
namespace {

constexpr float behind_band_m = 0.40f;
constexpr float finger_m = 0.015f;  // what hides an object is a gloved finger at least so thick
constexpr double whole_part =
    0.5;  // of a disc, that an object shows when it is apart from the hand

}  // namespace

Surface SceneModel::see(const RgbdFrame& frame, const std::string& object) const {
  const auto& classes = colors.at(object);
  return segmenter.moving_surface(frame, [&](Surface& points) {
    classes.assign(points);
    std::erase_if(points, [&](const SurfacePoint& point) {
      return point.position_m.z() > band_m + (point.body == Body::rest ? 0.0f : behind_band_m);
    });
  });
}

void SceneModel::split(Surface& surface, const std::string& object,
                       const Eigen::Vector3d& hand_m) const {
  const double radius_m = object_shape.at(object).radius_m;
  const double disc = segmenter.disc_pixels(radius_m, hand_m.z());
  split_from_hand(surface, hand_m, radius_m, static_cast<std::size_t>(whole_part * disc));
}

BodyView SceneModel::view_body(const RgbdFrame& frame, const std::string& object,
                               const Patch& patch, double reach_m, bool whole) const {
  auto around = segmenter.surface_around(frame, patch.centroid_m, reach_m);
  colors.at(object).assign(around);
  BodyView view{segmenter.depth_eye_m(), patch.points_m, {}};
  const double depth_sigma_m = depth_noise_at_1m * std::pow(patch.centroid_m.z(), 2);
  view.noise_ratio = std::max(1.0, depth_sigma_m / usual_depth_sigma_m);
  const Body own = like_the_hand.contains(object) ? Body::hand : Body::object;
  const bool gather = whole && own == Body::object;
  if (gather) view.on_m.clear();
  for (const auto& point : around) {
    const Eigen::Vector3f ray = point.position_m - view.eye_m.cast<float>();
    const bool near = (point.position_m.cast<double>() - patch.centroid_m).norm() < reach_m;
    const float thickness_m = point.body == Body::rest ? 0.0f : finger_m;
    if (point.body != own || !near)
      view.seen_past_m.push_back(point.position_m + thickness_m * ray.normalized());
    else if (gather)
      view.on_m.push_back(point.position_m);
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

}  // namespace touchtrace::label
