#include "pipeline/label/estimate/rounded_body.h"

#include <algorithm>
#include <cmath>

namespace touchtrace::label {
namespace {

constexpr double deepest_point_m = 1e-4;  // accuracy of the deepest point along the segment
constexpr int max_bisections = 20;        // where rounding of a long segment exceeds it
// Keeps points off a cylinder's axis, where the gradient is undefined.
constexpr double axis_offset_m = 1e-15;

/// Range of a segment's parameter (0 to 1) inside a box about the origin; nullopt if it misses it.
std::optional<std::pair<double, double>> within_box(const Eigen::Vector3d& from_m,
                                                    const Eigen::Vector3d& along_m,
                                                    const Eigen::Vector3d& half_extents_m) {
  double near = 0.0, far = 1.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (along_m[axis] == 0.0) {
      if (std::abs(from_m[axis]) > half_extents_m[axis]) return std::nullopt;
      continue;
    }
    const double middle = -from_m[axis] / along_m[axis],
                 half = half_extents_m[axis] / std::abs(along_m[axis]);
    near = std::max(near, middle - half), far = std::min(far, middle + half);
  }
  return near < far ? std::optional(std::pair{near, far}) : std::nullopt;
}

SurfaceDistance distance_from_box(const RoundedBody& body, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d beyond = point_m.cwiseAbs() - body.inner_m;
  const Eigen::Vector3d sign(point_m.x() < 0.0 ? -1.0 : 1.0, point_m.y() < 0.0 ? -1.0 : 1.0,
                             point_m.z() < 0.0 ? -1.0 : 1.0);
  if (beyond.x() <= 0.0 && beyond.y() <= 0.0 && beyond.z() <= 0.0) {
    Eigen::Index axis;
    const double largest = beyond.maxCoeff(&axis);
    return {largest - body.radius_m, sign[axis] * Eigen::Vector3d::Unit(axis)};
  }
  const Eigen::Vector3d outside = beyond.cwiseMax(0.0);
  const double norm = outside.norm();
  return {norm - body.radius_m, outside.cwiseProduct(sign) / norm};
}

}  // namespace

SurfaceDistance surface_distance(const RoundedBody& body, const Eigen::Vector3d& point_m) {
  if (body.core == Core::box) return distance_from_box(body, point_m);
  // In the half-plane through its axis and the point, a cylinder is a box.
  const Eigen::Vector2d radial(point_m.x() + axis_offset_m, point_m.y());
  const double radius_m = radial.norm();
  auto surface = distance_from_box(body, {radius_m, 0.0, point_m.z()});
  surface.outward.head<2>() = surface.outward.x() / radius_m * radial;
  return surface;
}

Eigen::Vector3d core_support_point(Core core, const Eigen::Vector3d& direction,
                                   const Eigen::Vector3d& inner_m) {
  Eigen::Vector3d point;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[axis] = direction[axis] < 0.0 ? -inner_m[axis] : inner_m[axis];
  if (core == Core::box) return point;
  const Eigen::Vector2d radial(direction.x() + axis_offset_m, direction.y());
  point.head<2>() = inner_m.x() * radial.normalized();
  return point;
}

double extent_beyond_plane_m(const RoundedBody& body, const Eigen::Isometry3d& camera_from_body,
                             const Eigen::Vector3d& outward) {
  const Eigen::Vector3d direction = camera_from_body.linear().transpose() * outward;
  return outward.dot(camera_from_body.translation()) +
         core_support_point(body.core, direction, body.inner_m).dot(direction) + body.radius_m;
}

double symmetric_rotation_distance(Core core, const Eigen::Quaterniond& from,
                                   const Eigen::Quaterniond& to) {
  const Eigen::Array4d part = (from.conjugate() * to).coeffs().array().abs();  // x y z w
  const double same = core == Core::box
                          ? part.maxCoeff()
                          : std::max(std::hypot(part[2], part[3]), std::hypot(part[0], part[1]));
  return 2.0 * std::acos(std::min(1.0, same));
}

std::optional<Eigen::Vector3d> deepest_point(const RoundedBody& body, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d along = to_m - from_m;
  const auto range = within_box(from_m, along, body.half_extents_m());
  if (!range) return std::nullopt;
  auto [near, far] = *range;
  const double length = along.norm();
  for (int i = 0; i < max_bisections && (far - near) * length > 2.0 * deepest_point_m; ++i) {
    const double half_way = 0.5 * (near + far);
    const auto surface = surface_distance(body, from_m + half_way * along);
    if (surface.distance_m > (far - half_way) * length) return std::nullopt;
    (surface.outward.dot(along) > 0.0 ? far : near) = half_way;
  }
  return from_m + 0.5 * (near + far) * along;
}

}  // namespace touchtrace::label
