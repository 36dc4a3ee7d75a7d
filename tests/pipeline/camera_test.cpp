#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/scene/camera/backdrop.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/renderer.h"
#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

Runtime& runtime() {
  static Runtime instance(choose_device(""));
  return instance;
}

SceneOptions small_images() {
  SceneOptions options;
  options.image_width = 320, options.image_height = 240;
  return options;
}

/// A camera whose images hold geometry only.
RgbdCamera exact_camera(const SceneOptions& options) {
  RgbdCamera camera = make_camera(options);
  camera.sensor = DepthSensor::exact();
  camera.color_noise_counts = 0.0;
  return camera;
}

/// A solid at a position of the colour camera's frame, in a general orientation.
PaintedSolid solid_before(const RgbdCamera& camera, ShapeKind kind, const Eigen::Vector3d& size_m,
                          const Eigen::Vector3d& position_m) {
  PaintedSolid painted;
  painted.solid.kind = kind, painted.solid.size_m = size_m;
  painted.solid.body_from_shape =
      camera.color_from_world.inverse() * Eigen::Translation3d(position_m) *
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.5, -0.3, 0.8).normalized());
  return painted;
}

/// A wall perpendicular to the depth camera's axis at the depth `depth_m`.
PaintedSolid wall_before(const RgbdCamera& camera, double depth_m) {
  PaintedSolid wall;
  wall.solid.kind = ShapeKind::box, wall.solid.size_m = {9.0, 9.0, 0.1};
  wall.solid.body_from_shape = (camera.depth_from_color * camera.color_from_world).inverse() *
                               Eigen::Translation3d(0.0, 0.0, depth_m + 0.1);
  return wall;
}

double distance_to(const Solid& solid, const Eigen::Vector3d& p) {
  const Eigen::Vector3d& s = solid.size_m;
  const double radial = p.head<2>().norm() - s.x();
  switch (solid.kind) {
    case ShapeKind::sphere:
      return p.norm() - s.x();
    case ShapeKind::capsule:
      return (p - Eigen::Vector3d(0, 0, std::clamp(p.z(), -s.y(), s.y()))).norm() - s.x();
    case ShapeKind::cylinder:
      return std::max(radial, std::abs(p.z()) - s.y());
    default:
      return (p.cwiseAbs() - s).maxCoeff();
  }
}

/// Checks every pixel of a depth image of one body: a measured point is on the surface, and no part
/// of the body is in front of it; without a measurement the ray misses the body. The argument of
/// `distance_to_surface` is a point in the body's frame.
void expect_depth_of(const RgbdCamera& camera, const Eigen::Isometry3d& world_from_body,
                     const std::function<double(const Eigen::Vector3d&)>& distance_to_surface,
                     const std::vector<std::uint16_t>& depth) {
  const Eigen::Isometry3d body_from_depth =
      (camera.depth_from_color * camera.color_from_world * world_from_body).inverse();
  const double tolerance_m =
      0.5 * camera.depth_unit_m + 2e-5;  // half a count, and single precision
  int hits = 0, wrong = 0;
  for (int v = 0; v < camera.depth.height; ++v)
    for (int u = 0; u < camera.depth.width; ++u) {
      const Eigen::Vector3d ray = camera.depth.unproject({u, v});
      const double hit_m =
          depth[static_cast<std::size_t>(v * camera.depth.width + u)] * camera.depth_unit_m;
      const auto distance = [&](double z) {
        return distance_to_surface(body_from_depth * (z * ray));
      };
      const double bound = tolerance_m * ray.norm();
      if (hit_m > 0.0) ++hits, wrong += !(std::abs(distance(hit_m)) <= bound);
      for (double z = 0.6; z < (hit_m > 0.0 ? hit_m : 1.4); z += 0.004)
        wrong += !(distance(z) >= -bound);
    }
  EXPECT_GT(hits, 200);
  EXPECT_EQ(wrong, 0);
}

TEST(Camera, DepthIsThatOfTheSurfaceOfEveryShape) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  const std::vector<std::pair<ShapeKind, Eigen::Vector3d>> shapes{
      {ShapeKind::sphere, {0.06, 0, 0}},
      {ShapeKind::box, {0.05, 0.03, 0.08}},
      {ShapeKind::capsule, {0.03, 0.07, 0}},
      {ShapeKind::cylinder, {0.04, 0.06, 0}}};
  for (const auto& [kind, size_m] : shapes) {
    SCOPED_TRACE(static_cast<int>(kind));
    const PaintedSolid solid = solid_before(camera, kind, size_m, {0.12, -0.07, 0.95});
    const RgbdFrame frame = renderer.render(static_exposure({solid}), "test", 0);
    expect_depth_of(
        camera, solid.solid.body_from_shape,
        [&](const Eigen::Vector3d& p) { return distance_to(solid.solid, p); }, frame.depth);
  }
}

TEST(Camera, DepthIsThatOfTheContactSurface) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  for (const ObjectSpec& object : objects()) {
    SCOPED_TRACE(object.name);
    const Eigen::Isometry3d world_from_body =
        camera.color_from_world.inverse() * Eigen::Translation3d(0.02, -0.03, 0.75) *
        Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.5, -0.3, 0.8).normalized());
    std::vector<PaintedSolid> solids;
    for (const Solid& solid : object.solids) {
      solids.push_back({solid});
      solids.back().solid.body_from_shape = world_from_body * solid.body_from_shape;
    }
    expect_depth_of(
        camera, world_from_body, [&](const Eigen::Vector3d& p) { return distance_m(object, p); },
        renderer.render(static_exposure(solids), "test", 0).depth);
  }
}

std::vector<PaintedSolid> room_with_person() {
  auto solids = room_solids();
  for (const PaintedSolid& solid : person_solids(0.3)) solids.push_back(solid);
  return solids;
}

TEST(Camera, DepthOfSeveralSolidsIsThatOfTheNearest) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  std::vector<std::uint16_t> nearest(
      static_cast<std::size_t>(camera.depth.width * camera.depth.height));
  const auto solids = room_with_person();
  for (const PaintedSolid& solid : solids) {
    const auto alone = renderer.render(static_exposure({solid}), "test", 0).depth;
    for (std::size_t i = 0; i < alone.size(); ++i)
      if (alone[i] > 0 && (nearest[i] == 0 || alone[i] < nearest[i])) nearest[i] = alone[i];
  }
  EXPECT_EQ(renderer.render(static_exposure(solids), "test", 0).depth, nearest);
}

TEST(Camera, ColorOfSeveralSolidsIsThatOfTheNearest) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  auto solids = room_with_person();
  const auto expected = renderer.render(static_exposure(solids), "test", 0).color;
  solids.push_back(wall_before(camera, 3.5));  // behind everything
  EXPECT_EQ(renderer.render(static_exposure(solids), "test", 0).color, expected);
}

TEST(Camera, MotionBlurAveragesTheExposure) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  const Eigen::Vector3d here(-0.2, 0.0, 1.0), there(0.2, 0.0, 1.0);
  const auto sphere = [&](const Eigen::Vector3d& place) {
    return std::vector{solid_before(camera, ShapeKind::sphere, {0.05, 0, 0}, place)};
  };
  const auto middle = [&](const RgbdFrame& frame, const Eigen::Vector3d& place) {
    const Eigen::Vector2i pixel = camera.color.project(place).array().round().cast<int>();
    return double(
        frame.color[static_cast<std::size_t>(3 * (pixel.y() * camera.color.width + pixel.x()))]);
  };
  const RgbdFrame blurred = renderer.render(
      {{sphere(here), sphere(here), sphere(there), sphere(there)}, sphere(here)}, "test", 0);
  for (const Eigen::Vector3d& place : {here, there}) {
    const double whole = middle(renderer.render(static_exposure(sphere(place)), "test", 0), place);
    EXPECT_GT(whole, 60.0);
    EXPECT_NEAR(middle(blurred, place), whole * std::sqrt(0.5),
                2.0);  // pixel values are square roots of intensities
  }
}

/// Centre of the pixels that an overexposed sphere saturates: all that it touches, so that its
/// outline is dilated evenly.
Eigen::Vector2d centre_of_bright(const RgbdFrame& frame, int width) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < frame.depth.size(); ++i)
    if (frame.color[3 * i] == 255)
      sum += Eigen::Vector2d(static_cast<double>(i % width), static_cast<double>(i / width)),
          ++count;
  return sum / count;
}

TEST(Camera, SpheresAppearWhereTheDistortedPinholeProjectsThem) {
  const RgbdCamera camera = exact_camera(small_images());
  Renderer renderer(runtime(), camera, 1);
  for (double x : {-0.38, 0.0, 0.38})
    for (double y : {-0.28, 0.01, 0.28}) {
      // Small: the centre of a sphere's image is f tan(angle) (r / z)^2 < 0.04 px from the image of
      // its centre.
      PaintedSolid sphere = solid_before(camera, ShapeKind::sphere, {0.016, 0, 0}, {x, y, 1.0});
      sphere.solid.color.setConstant(1000.0);
      const RgbdFrame frame = renderer.render(static_exposure({sphere}), "test", 0);
      const Eigen::Vector2d expected = camera.color.project({x, y, 1.0});
      EXPECT_LT((centre_of_bright(frame, camera.color.width) - expected).norm(), 0.2)
          << x << ' ' << y;
    }
}

struct Moments {
  double mean, std;
};

Moments moments(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

std::vector<double> measured_m(const RgbdFrame& frame, const RgbdCamera& camera) {
  std::vector<double> values;
  for (int v = 1; v < camera.depth.height - 1; ++v)
    for (int u = 1; u < camera.depth.width - 1; ++u)
      values.push_back(frame.depth[static_cast<std::size_t>(v * camera.depth.width + u)] *
                       camera.depth_unit_m);
  return values;
}

TEST(Camera, DepthNoiseIsThatOfTheDisparity) {
  RgbdCamera camera = make_camera(small_images());
  camera.sensor.scale = 1.0, camera.sensor.offset_m = 0.0;
  camera.sensor.disparity_step_px = 0.0;
  Renderer renderer(runtime(), camera, 1);
  for (double z : {0.8, 1.1, 2.0}) {
    const auto depth =
        measured_m(renderer.render(static_exposure({wall_before(camera, z)}), "noise", 0), camera);
    const double focal_baseline = 2.0 * camera.depth.fx * camera.sensor.baseline_m;
    const double expected_m = z * z / focal_baseline * camera.sensor.disparity_sigma_px;
    const double independent =
        static_cast<double>(depth.size()) / 9.0;  // the noise is a mean of 3x3
    EXPECT_NEAR(moments(depth).std / expected_m, 1.0, 4.0 / std::sqrt(2.0 * independent)) << z;
    EXPECT_NEAR(moments(depth).mean, z, 4.0 * expected_m / std::sqrt(independent) + 2e-5) << z;
  }
}

TEST(Camera, DepthIsQuantisedInEighthsOfADisparity) {
  RgbdCamera camera = make_camera(small_images());
  camera.sensor.scale = 1.004, camera.sensor.offset_m = 0.006;
  Renderer renderer(runtime(), camera, 1);
  const auto depth =
      measured_m(renderer.render(static_exposure({wall_before(camera, 1.1)}), "noise", 0), camera);
  const double focal_baseline = 2.0 * camera.depth.fx * camera.sensor.baseline_m;
  double worst_m = 0.0;
  for (double measured : depth) {
    const double z = camera.sensor.offset_m + camera.sensor.scale * measured;
    const double on_step = focal_baseline / (std::round(8.0 * focal_baseline / z) / 8.0);
    worst_m = std::max(worst_m, std::abs(on_step - z));
  }
  EXPECT_LE(worst_m, 0.5 * camera.depth_unit_m * camera.sensor.scale + 1e-6);
}

TEST(Camera, NearObjectsCastAnOcclusionShadow) {
  RgbdCamera camera = exact_camera(small_images());
  camera.sensor.holes = true;
  Renderer renderer(runtime(), camera, 1);
  const double near_m = 1.0, far_m = 2.0;
  PaintedSolid post = wall_before(camera, near_m);
  post.solid.size_m.x() = 0.1;
  const auto depth =
      renderer.render(static_exposure({post, wall_before(camera, far_m)}), "noise", 0).depth;
  const int width = camera.depth.width, row = camera.depth.height / 2 * width;
  const int holes =
      static_cast<int>(std::count(depth.begin() + row + 1, depth.begin() + row + width - 1, 0));
  const double shadow_px =
      camera.depth.fx * camera.sensor.baseline_m * (1.0 / near_m - 1.0 / far_m);
  EXPECT_NEAR(holes, shadow_px, 4.0);  // and up to two ragged pixels at each of the two edges
}

TEST(Camera, ColorNoiseIsThatOfTheSensor) {
  for (int width : {320, 640}) {
    SceneOptions options;
    options.image_width = width, options.image_height = width * 3 / 4;
    const RgbdCamera camera = make_camera(options);
    Renderer renderer(runtime(), camera, 1);
    const auto a = renderer.render(static_exposure(room_solids()), "noise", 1).color;
    const auto b = renderer.render(static_exposure(room_solids()), "noise", 2).color;
    std::vector<double> difference;
    for (std::size_t i = 0; i < a.size(); ++i) difference.push_back(double(a[i]) - double(b[i]));
    const double sigma = camera.color_noise_counts * width / sensor_width_px;
    const double expected =
        std::sqrt(2.0 * (sigma * sigma + 1.0 / 12.0));  // and rounding to counts
    EXPECT_NEAR(moments(difference).std / expected, 1.0, 0.02) << width;
  }
}

TEST(Camera, SameSeedSameBitsInAnyOrder) {
  const RgbdCamera camera = make_camera(small_images());
  Renderer first(runtime(), camera, 5), second(runtime(), camera, 5), other(runtime(), camera, 6);
  const Exposure room = static_exposure(room_solids());
  const RgbdFrame zero = first.render(room, "frame", 0), one = first.render(room, "frame", 1);
  const RgbdFrame one_again = second.render(room, "frame", 1),
                  zero_again = second.render(room, "frame", 0);
  EXPECT_EQ(zero.color, zero_again.color);
  EXPECT_EQ(zero.depth, zero_again.depth);
  EXPECT_EQ(one.color, one_again.color);
  EXPECT_EQ(one.depth, one_again.depth);
  EXPECT_NE(zero.color, one.color);
  EXPECT_NE(zero.color, other.render(room, "frame", 0).color);
}

TEST(CameraClock, SequenceIncludesDroppedFrames) {
  const CameraClock clock = make_camera_clock(small_images());
  const auto frames = clock.frames_between(10.0, 210.0);
  const auto all = static_cast<double>(frames.back() - frames.front() + 1);
  EXPECT_NEAR(all, 200.0 / clock.period_s, 2.0);
  EXPECT_NEAR(1.0 - static_cast<double>(frames.size()) / all, clock.drop_share,
              4.0 * std::sqrt(clock.drop_share / all));
  EXPECT_LT(static_cast<double>(frames.size()), all);
  EXPECT_GE(clock.true_time_s(frames.front()), 10.0);
  EXPECT_LT(clock.true_time_s(frames.back()), 210.0);
}

TEST(CameraClock, ArrivalIsLatencyPlusExponentialJitter) {
  const CameraClock clock = make_camera_clock(small_images());
  std::vector<double> jitter;
  for (std::uint64_t i = 1000; i < 11000; ++i)
    jitter.push_back(clock.arrival_s(i) - clock.true_time_s(i) - clock.latency_s);
  EXPECT_GE(*std::ranges::min_element(jitter), -1e-9);
  // Four standard errors of the mean and of the standard deviation of 10000 exponential numbers.
  EXPECT_NEAR(moments(jitter).mean / clock.jitter_s, 1.0, 0.04);
  EXPECT_NEAR(moments(jitter).std / clock.jitter_s, 1.0, 0.08);
}

}  // namespace
}  // namespace touchtrace::scene
