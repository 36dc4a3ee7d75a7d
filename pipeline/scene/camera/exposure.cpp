#include "pipeline/scene/camera/exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "engine/base/random.h"
#include "pipeline/scene/camera/backdrop.h"
#include "pipeline/scene/camera/visible.h"

namespace touchtrace::scene {
namespace {

constexpr int color_instants = 4, circle_points = 16;
constexpr int max_box_error_px = 3;
constexpr double sleeve_contrast = 0.12, sleeve_waves_per_m = 23.0;
constexpr double glove_contrast = 0.10, glove_waves_per_m = 90.0;
constexpr double object_contrast = 0.08, object_waves_per_m = 45.0;

RigidState interpolate(const RigidState& a, const RigidState& b, double w) {
  return {(1.0 - w) * a.position_m + w * b.position_m, a.orientation.slerp(w, b.orientation),
          (1.0 - w) * a.velocity_m_per_s + w * b.velocity_m_per_s,
          (1.0 - w) * a.angular_velocity_rad_per_s + w * b.angular_velocity_rad_per_s};
}

void append(std::vector<PaintedSolid>& scene, const std::vector<Solid>& solids, double contrast,
            double waves_per_m) {
  for (const auto& solid : solids)
    scene.push_back({solid, Pattern::cloth, {contrast, waves_per_m, 0.0}});
}

void append(std::vector<PaintedSolid>& scene, const std::vector<PaintedSolid>& solids) {
  scene.insert(scene.end(), solids.begin(), solids.end());
}

std::vector<PaintedSolid> scene_at(const ClipMotion& motion, const SceneOptions& options,
                                   double time_s) {
  const ObjectSpec& object = options.object;
  const SceneSample sample = sample_at(motion, time_s);
  std::vector<PaintedSolid> scene = room_solids();
  append(scene, person_solids(time_s));
  append(scene, {forearm_solid(sample)}, sleeve_contrast, sleeve_waves_per_m);
  append(scene, hand_solids(sample, hand_model(options.parameters.hand)), glove_contrast,
         glove_waves_per_m);
  append(scene, object_solids(object, sample), object_contrast, object_waves_per_m);
  append(scene, ball_solids(object, sample), object_contrast, object_waves_per_m);
  return scene;
}

struct PixelBounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max()), high = -low;

  void include(const Eigen::Vector2d& pixel) {
    low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
  }
};

/// Points whose convex hull, dilated by rounding_m(), is nearly the solid.
std::vector<Eigen::Vector3d> hull_points(const Solid& solid) {
  const Eigen::Vector3d& s = solid.size_m;
  const bool is_box = solid.kind == ShapeKind::box;
  const double half_length = is_box ? s.z() : solid.kind == ShapeKind::sphere ? 0.0 : s.y();
  std::vector<Eigen::Vector3d> points;
  for (double end : {-half_length, half_length}) {
    if (is_box)
      for (double x : {-s.x(), s.x()})
        for (double y : {-s.y(), s.y()}) points.emplace_back(x, y, end);
    else if (solid.kind == ShapeKind::cylinder)
      for (int i = 0; i < circle_points; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / circle_points;
        points.emplace_back(s.x() * std::cos(angle), s.x() * std::sin(angle), end);
      }
    else
      points.emplace_back(0.0, 0.0, end);
  }
  return points;
}

double rounding_m(const Solid& solid) {
  return solid.kind == ShapeKind::sphere || solid.kind == ShapeKind::capsule ? solid.size_m.x()
                                                                             : 0.0;
}

void include(PixelBounds& bounds, const Solid& solid, const RgbdCamera& camera) {
  for (const Eigen::Vector3d& point : hull_points(solid)) {
    const Eigen::Vector3d p = camera.color_from_world * (solid.body_from_shape * point);
    if (p.z() < 0.1) continue;
    const Eigen::Vector2d pixel = camera.color.project(p);
    const Eigen::Vector2d radius =
        rounding_m(solid) / p.z() * Eigen::Vector2d(camera.color.fx, camera.color.fy);
    bounds.include(pixel - radius), bounds.include(pixel + radius);
  }
}

}  // namespace

SceneSample sample_at(const ClipMotion& motion, double time_s) {
  const auto& samples = motion.samples;
  const double last = static_cast<double>(samples.size() - 1);
  const double place = std::clamp((time_s - samples.front().time_s) * sample_rate_hz, 0.0, last);
  const auto i = std::min(static_cast<std::size_t>(place), samples.size() - 1);
  const SceneSample &a = samples[i], &b = samples[std::min(i + 1, samples.size() - 1)];
  const double w = place - static_cast<double>(i);
  SceneSample sample = w < 0.5 ? a : b;
  sample.time_s = time_s;
  sample.hand = interpolate(a.hand, b.hand, w);
  sample.object = interpolate(a.object, b.object, w);
  if (a.ball && b.ball) sample.ball = interpolate(*a.ball, *b.ball, w);
  return sample;
}

Exposure expose(const ClipMotion& motion, const SceneOptions& options, double middle_s,
                double exposure_s) {
  Exposure exposure;
  for (int i = 0; i < color_instants; ++i)
    exposure.color.push_back(
        scene_at(motion, options, middle_s + exposure_s * ((i + 0.5) / color_instants - 0.5)));
  exposure.depth = scene_at(motion, options, middle_s);
  return exposure;
}

PixelBox draw_box(const std::vector<Solid>& solids, const RgbdCamera& camera, std::uint64_t seed,
                  int clip, std::string_view target) {
  PixelBounds bounds;
  for (const auto& solid : solids) include(bounds, solid, camera);
  RandomStream random(seed, "marked box " + std::string(target));
  random.seek(static_cast<std::uint64_t>(clip) * 64);
  const auto perturb = [&](double value, int size) {
    const auto error =
        static_cast<double>(random.below(2 * max_box_error_px + 1)) - max_box_error_px;
    return static_cast<int>(std::clamp(std::round(value) + error, 0.0, static_cast<double>(size)));
  };
  const int left = perturb(bounds.low.x(), camera.color.width),
            right = perturb(bounds.high.x(), camera.color.width);
  const int top = perturb(bounds.low.y(), camera.color.height),
            bottom = perturb(bounds.high.y(), camera.color.height);
  return {left, top, right - left, bottom - top};
}

}  // namespace touchtrace::scene
