#include "pipeline/scene/camera/packed_solids.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "engine/base/error.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double nearest_plane_m = 0.02;  // NEAR of solids.clh
constexpr std::size_t region_lines = 16;  // LANES of pixel_vectors.clh
constexpr double always = 1e9;
constexpr float never = 1e30f;  // FAR of solids.clh

Vector3d half_extents(const Solid& solid) {
  const Vector3d& s = solid.size_m;
  switch (solid.kind) {
    case ShapeKind::sphere:
      return Vector3d::Constant(s.x());
    case ShapeKind::capsule:
      return {s.x(), s.x(), s.x() + s.y()};
    case ShapeKind::cylinder:
      return {s.x(), s.x(), s.y()};
    default:
      return s;
  }
}

/// Approximate depth of the solid's nearest point, for sorting.
double near_depth_m(const PaintedSolid& painted, const Eigen::Isometry3d& camera_from_world) {
  const Vector3d centre = camera_from_world * painted.solid.body_from_shape.translation();
  return centre.z() - half_extents(painted.solid).minCoeff();
}

std::vector<std::size_t> order_by_depth(const std::vector<PaintedSolid>& solids,
                                        const Eigen::Isometry3d& camera_from_world) {
  std::vector<double> depth;
  for (const auto& solid : solids) depth.push_back(near_depth_m(solid, camera_from_world));
  std::vector<std::size_t> order(solids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return depth[i]; });
  return order;
}

SolidBounds total_bounds(const std::vector<std::vector<PaintedSolid>>& instants, std::size_t i,
                         const Eigen::Isometry3d& camera_from_world) {
  SolidBounds all;
  for (const auto& solids : instants)
    all.include(projected_bounds(solids[i].solid, camera_from_world));
  return all;
}

/// Slightly smaller depth, below the rounding errors of rays in float.
float below(float depth_m) { return (1.0f - 1e-5f) * depth_m; }

/// Affine functions of x', y' of a bounding box, for hit_from() of solids.clh: first the inverse
/// depths at which rays enter its slabs, then the margins by which they enter one slab before they
/// leave another. At most three faces are visible, with six edges around them.
std::array<Vector3d, region_lines> separating_lines(const Eigen::Isometry3d& shape_from_camera,
                                                    const Vector3d& half) {
  const Vector3d& origin = shape_from_camera.translation();
  const auto along = [&](int i) -> Vector3d { return shape_from_camera.linear().row(i); };
  std::array<Vector3d, region_lines> lines;
  lines.fill({0.0, 0.0, always});
  std::size_t next = 3;
  for (int i = 0; i < 3; ++i) {
    const double before = std::abs(origin[i]) - half[i];
    if (before <= 0.0) continue;
    const Vector3d enters = along(i) * (origin[i] > 0.0 ? -1.0 : 1.0) / before;
    lines[i] = enters;
    for (int k = 0; k < 3; ++k) {
      if (k == i) continue;
      const double to_high = half[k] - origin[k], to_low = half[k] + origin[k];
      if (to_high > 0.0) lines.at(next++) = enters - along(k) / to_high;
      if (to_low > 0.0) lines.at(next++) = enters + along(k) / to_low;
    }
  }
  return lines;
}

/// Whether the solid moves by more than a twentieth of a pixel.
bool is_moving(const std::vector<std::vector<PaintedSolid>>& instants, std::size_t i) {
  constexpr double max_still_m = 1e-4;
  const auto pose = [&](const auto& solids) { return solids[i].solid.body_from_shape.matrix(); };
  return std::ranges::any_of(instants, [&](const auto& solids) {
    return !((pose(solids) - pose(instants.front())).cwiseAbs().maxCoeff() <= max_still_m);
  });
}

/// Coefficients of slab_inverse() of solids.clh for one axis: factor and offset from a ray's
/// direction to the inverse depth of entry, then the two factors for the exit.
std::array<float, 4> slab(double camera_at, double half_m) {
  const auto origin = static_cast<float>(camera_at), half = static_cast<float>(half_m);
  const float before = std::abs(origin) - half, sign = origin > 0.0f ? -1.0f : 1.0f;
  if (before <= 0.0f) return {0.0f, never, 1.0f / (half - origin), -1.0f / (half + origin)};
  const float leaves = sign / (std::abs(origin) + half);
  return {sign / before, 0.0f, leaves, leaves};
}

/// Properties of a solid over all rendered instants.
struct Appearance {
  SolidBounds bounds;
  bool is_moving;
};

void append(std::vector<float>& packed, const PaintedSolid& painted, const Appearance& seen,
            const Eigen::Isometry3d& camera_from_world, const Vector3d& lamp) {
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
  const SolidBounds& b = seen.bounds;
  for (const float bound : {below(b.nearest_m), b.x_low, b.x_high, b.y_low, b.y_high})
    packed.push_back(bound);
  push(seen.is_moving);
  for (int i = 0; i < 3; ++i) packed.push_back(1.0f / static_cast<float>(solid.size_m[i]));
  const auto lines = separating_lines(shape_from_camera, half_extents(solid));
  for (int i = 0; i < 3; ++i)
    for (const Vector3d& line : lines) push(line[i]);
  for (int i = 0; i < 3; ++i)
    for (const float value : slab(shape_from_camera.translation()[i], solid.size_m[i]))
      packed.push_back(value);
  const Vector3d to_lamp = solid.body_from_shape.linear().transpose() * lamp;
  for (int i = 0; i < 3; ++i) push(to_lamp[i]);
  push(0.0);
}

using Corners = std::array<Vector3d, 8>;

/// Corners of the bounding box, camera's frame; bit k of an index is the side along axis k.
Corners corners_of(const Solid& solid, const Eigen::Isometry3d& camera_from_world) {
  const Eigen::Isometry3d camera_from_shape = camera_from_world * solid.body_from_shape;
  const Vector3d half = half_extents(solid);
  Corners corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners[i] = camera_from_shape * half.cwiseProduct(sign);
  }
  return corners;
}

/// Intersection of the edge from `front` to `behind` with the near plane.
Vector3d clip_to_near_plane(const Vector3d& front, const Vector3d& behind) {
  const double share = (front.z() - nearest_plane_m) / (front.z() - behind.z());
  return front + share * (behind - front);
}

}  // namespace

void SolidBounds::include(const Vector3d& point) {
  const auto x = static_cast<float>(point.x() / point.z()),
             y = static_cast<float>(point.y() / point.z());
  x_low = std::min(x_low, x), x_high = std::max(x_high, x);
  y_low = std::min(y_low, y), y_high = std::max(y_high, y);
  nearest_m = std::min(nearest_m, static_cast<float>(point.z()));
}

void SolidBounds::include(const SolidBounds& other) {
  x_low = std::min(x_low, other.x_low), x_high = std::max(x_high, other.x_high);
  y_low = std::min(y_low, other.y_low), y_high = std::max(y_high, other.y_high);
  nearest_m = std::min(nearest_m, other.nearest_m);
}

SolidBounds projected_bounds(const Solid& solid, const Eigen::Isometry3d& camera_from_world) {
  const auto corners = corners_of(solid, camera_from_world);
  const auto is_before = [](const Vector3d& p) { return p.z() > nearest_plane_m; };
  SolidBounds bounds;
  for (int i = 0; i < 8; ++i) {
    if (!is_before(corners[i])) continue;
    bounds.include(corners[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d& neighbour = corners[i ^ (1 << axis)];
      if (!is_before(neighbour)) bounds.include(clip_to_near_plane(corners[i], neighbour));
    }
  }
  return bounds;
}

std::vector<float> pack_solids(const std::vector<std::vector<PaintedSolid>>& instants,
                               const Eigen::Isometry3d& camera_from_world, const Vector3d& lamp) {
  const auto order = order_by_depth(instants.front(), camera_from_world);
  if (order.size() > max_solids)
    throw failure(fmt::format("{} solids in view exceed the renderer's limit of {}", order.size(),
                              max_solids),
                  "use an object with fewer solids");
  std::vector<float> packed;
  packed.reserve(instants.size() * order.size() * packed_solid_floats);
  std::vector<Appearance> seen;
  for (std::size_t i : order)
    seen.push_back({total_bounds(instants, i, camera_from_world), is_moving(instants, i)});
  for (const auto& solids : instants)
    for (std::size_t k = 0; k < order.size(); ++k)
      append(packed, solids[order[k]], seen[k], camera_from_world, lamp);
  return packed;
}

}  // namespace touchtrace::scene
