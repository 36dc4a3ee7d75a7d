#include "pipeline/scene/packed_solids.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "engine/base/error.h"

namespace touchtrace::scene {
namespace {

constexpr float unbounded = 1e9f;
constexpr double nearest_plane_m = 0.02;

Eigen::Vector3d half_extents(const Solid& solid) {
  const Eigen::Vector3d& s = solid.size_m;
  switch (solid.kind) {
    case ShapeKind::sphere:
      return Eigen::Vector3d::Constant(s.x());
    case ShapeKind::capsule:
      return {s.x(), s.x(), s.x() + s.y()};
    case ShapeKind::cylinder:
      return {s.x(), s.x(), s.y()};
    default:
      return s;
  }
}

/// Least distance of the bounding box's corners: a rough order is enough.
double nearness(const PaintedSolid& painted, const Eigen::Isometry3d& camera_from_world) {
  const Eigen::Vector3d centre = camera_from_world * painted.solid.body_from_shape.translation();
  return centre.z() - half_extents(painted.solid).minCoeff();
}

std::vector<std::size_t> near_first(const std::vector<PaintedSolid>& solids,
                                    const Eigen::Isometry3d& camera_from_world) {
  std::vector<double> depth;
  for (const auto& solid : solids) depth.push_back(nearness(solid, camera_from_world));
  std::vector<std::size_t> order(solids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return depth[i]; });
  return order;
}

std::array<float, 4> bounds_of_all(const std::vector<std::vector<PaintedSolid>>& instants,
                                   std::size_t i, const Eigen::Isometry3d& camera_from_world) {
  std::array<float, 4> all{unbounded, -unbounded, unbounded, -unbounded};
  for (const auto& solids : instants) {
    const auto b = projected_bounds(solids[i].solid, camera_from_world);
    all = {std::min(all[0], b[0]), std::max(all[1], b[1]), std::min(all[2], b[2]),
           std::max(all[3], b[3])};
  }
  return all;
}

void append(std::vector<float>& packed, const PaintedSolid& painted,
            const std::array<float, 4>& bounds, const Eigen::Isometry3d& camera_from_world) {
  const Solid& solid = painted.solid;
  const Eigen::Isometry3d shape_from_camera = (camera_from_world * solid.body_from_shape).inverse();
  const auto push = [&](double value) { packed.push_back(static_cast<float>(value)); };
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) push(shape_from_camera.linear()(row, column));
  for (int i = 0; i < 3; ++i) push(shape_from_camera.translation()[i]);
  for (int i = 0; i < 3; ++i) push(solid.size_m[i]);
  push(static_cast<int>(solid.kind));
  for (int i = 0; i < 3; ++i) push(solid.color[i]);
  push(static_cast<int>(painted.pattern));
  for (double value : painted.pattern_values) push(value);
  push(0.0);
  packed.insert(packed.end(), bounds.begin(), bounds.end());
}

}  // namespace

std::array<float, 4> projected_bounds(const Solid& solid,
                                      const Eigen::Isometry3d& camera_from_world) {
  const Eigen::Isometry3d camera_from_shape = camera_from_world * solid.body_from_shape;
  const Eigen::Vector3d half = half_extents(solid);
  std::array<float, 4> b{unbounded, -unbounded, unbounded, -unbounded};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Eigen::Vector3d p = camera_from_shape * half.cwiseProduct(sign);
    if (p.z() < nearest_plane_m) return {-unbounded, unbounded, -unbounded, unbounded};
    const auto x = static_cast<float>(p.x() / p.z()), y = static_cast<float>(p.y() / p.z());
    b = {std::min(b[0], x), std::max(b[1], x), std::min(b[2], y), std::max(b[3], y)};
  }
  return b;
}

std::vector<float> pack_solids(const std::vector<std::vector<PaintedSolid>>& instants,
                               const Eigen::Isometry3d& camera_from_world) {
  const auto order = near_first(instants.front(), camera_from_world);
  if (order.size() > max_solids)
    throw failure(fmt::format("{} solids are in view", order.size()),
                  fmt::format("build hand and object of fewer: {} can be rendered", max_solids));
  std::vector<float> packed;
  packed.reserve(instants.size() * order.size() * packed_solid_floats);
  for (const auto& solids : instants)
    for (std::size_t i : order)
      append(packed, solids[i], bounds_of_all(instants, i, camera_from_world), camera_from_world);
  return packed;
}

}  // namespace touchtrace::scene
