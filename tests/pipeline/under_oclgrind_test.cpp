// Run by scripts/oclgrind_kernels under oclgrind: the rendering kernels on a small image.
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {
namespace {

/// A box across the entire view, with a solid of each kind and pattern before it, some at the
/// image's edges.
std::vector<PaintedSolid> one_of_each(const RgbdCamera& camera) {
  const auto at = [&](double x, double y, double depth_m) -> Eigen::Isometry3d {
    return camera.color_from_world.inverse() * Eigen::Translation3d(x, y, depth_m) *
           Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.5, -0.3, 0.8).normalized());
  };
  std::vector<PaintedSolid> solids(5);
  const auto put = [&](int i, ShapeKind kind, Eigen::Vector3d size_m, Eigen::Isometry3d pose) {
    solids[i].solid.kind = kind, solids[i].solid.size_m = size_m;
    solids[i].solid.body_from_shape = pose;
  };
  put(0, ShapeKind::box, {3.0, 3.0, 0.1}, at(0.0, 0.0, 2.0));
  put(1, ShapeKind::sphere, {0.1, 0.0, 0.0}, at(0.0, 0.0, 1.0));
  put(2, ShapeKind::capsule, {0.05, 0.1, 0.0}, at(-0.5, 0.3, 1.0));
  put(3, ShapeKind::cylinder, {0.08, 0.1, 0.0}, at(0.5, -0.3, 0.9));
  put(4, ShapeKind::box, {0.1, 0.1, 0.01}, at(0.2, 0.2, 0.8));
  solids[0].pattern = Pattern::cloth, solids[0].pattern_values = {0.3, 20.0, 0.0};
  solids[4].pattern = Pattern::chessboard, solids[4].pattern_values = {0.02, 8.0, 6.0};
  return solids;
}

TEST(UnderOclgrind, RenderingKernelsOnASmallImage) {
  SceneOptions options;
  options.image_width = 32, options.image_height = 24;
  const RgbdCamera camera = make_camera(options);
  Runtime runtime(choose_device(""));
  const RgbdFrame frame =
      Renderer(runtime, camera, 1).render(static_exposure(one_of_each(camera)), "frame", 0, 1);
  const auto [darkest, brightest] = std::ranges::minmax(frame.color);
  const auto [nearest, farthest] = std::ranges::minmax(frame.depth);
  EXPECT_LT(darkest, brightest);
  EXPECT_LT(nearest, farthest);
}

}  // namespace
}  // namespace touchtrace::scene
