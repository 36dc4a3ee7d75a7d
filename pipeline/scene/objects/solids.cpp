#include "pipeline/scene/objects/solids.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

/// Normalizes `v`; returns the z axis where it is 0.
Lanes3 direction(const Lanes3& v) {
  const Lanes length = norm(v);
  const LaneMask is_some = length > 0.0;
  const Lanes inverse = is_some ? 1.0 / length : Lanes{};
  return {inverse * v.x, inverse * v.y, is_some ? inverse * v.z : broadcast(1.0)};
}

/// `value` with the sign of `s`.
Lanes copy_sign(double value, Lanes s) { return s < 0.0 ? broadcast(-value) : broadcast(value); }

/// Offset from the nearest point of a capsule's axis.
Lanes3 from_axis(const Lanes3& p, double half_length) {
  return {p.x, p.y, p.z - min(max(p.z, broadcast(-half_length)), broadcast(half_length))};
}

Lanes3 box_excess(const Vector3d& half, const Lanes3& p) {
  return {abs(p.x) - half.x(), abs(p.y) - half.y(), abs(p.z) - half.z()};
}

Lanes3 positive(const Lanes3& v) {
  return {max(v.x, Lanes{}), max(v.y, Lanes{}), max(v.z, Lanes{})};
}

Lanes box_distance_m(const Vector3d& half, const Lanes3& p) {
  const Lanes3 excess = box_excess(half, p);
  const Lanes depth = max(max(excess.x, excess.y), excess.z);
  return depth > 0.0 ? norm(positive(excess)) : depth;
}

Lanes3 box_normal(const Vector3d& half, const Lanes3& p) {
  const Lanes3 excess = box_excess(half, p), outside = positive(excess);
  const LaneMask x = (excess.x >= excess.y) & (excess.x >= excess.z),
                 y = ~x & (excess.y >= excess.z);
  const Lanes one = broadcast(1.0);
  const Lanes3 face{x ? one : Lanes{}, y ? one : Lanes{}, x | y ? Lanes{} : one};
  const Lanes3 n = select(dot(outside, outside) > 0.0, direction(outside), face);
  return {copy_sign(1.0, p.x) * n.x, copy_sign(1.0, p.y) * n.y, copy_sign(1.0, p.z) * n.z};
}

/// Signed distances from a cylinder's side and from its ends.
struct CylinderExcess {
  Lanes side, end;

  CylinderExcess(const Vector3d& size, const Lanes3& p)
      : side(sqrt(p.x * p.x + p.y * p.y) - size[0]), end(abs(p.z) - size[1]) {}
  LaneMask is_beyond_rim() const { return (side > 0.0) & (end > 0.0); }
};

Lanes cylinder_distance_m(const Vector3d& size, const Lanes3& p) {
  const CylinderExcess excess(size, p);
  return excess.is_beyond_rim() ? sqrt(excess.side * excess.side + excess.end * excess.end)
                                : max(excess.side, excess.end);
}

Lanes3 cylinder_normal(const Vector3d& size, const Lanes3& p) {
  const CylinderExcess excess(size, p);
  const Lanes rho = excess.side + size[0];
  const LaneMask is_off = rho > 0.0;
  const Lanes3 radial{is_off ? p.x / rho : broadcast(1.0), is_off ? p.y / rho : Lanes{}, Lanes{}};
  const Lanes3 axial{Lanes{}, Lanes{}, copy_sign(1.0, p.z)};
  const Lanes3 rim = direction(excess.side * radial + excess.end * axial);
  return select(excess.is_beyond_rim(), rim, select(excess.side > excess.end, radial, axial));
}

Lanes3 in_shape(const Solid& solid, const Lanes3& points) {
  return product(solid.body_from_shape.linear().transpose(),
                 points - Lanes3::all(solid.body_from_shape.translation()));
}

}  // namespace

Lanes distance_m(const Solid& solid, const Lanes3& points) {
  const Vector3d& size = solid.size_m;
  const Lanes3 p = in_shape(solid, points);
  switch (solid.kind) {
    case ShapeKind::sphere:
      return norm(p) - size[0];
    case ShapeKind::capsule:
      return norm(from_axis(p, size[1])) - size[0];
    case ShapeKind::cylinder:
      return cylinder_distance_m(size, p);
    case ShapeKind::box:
      break;
  }
  return box_distance_m(size, p);
}

Lanes3 normal(const Solid& solid, const Lanes3& points) {
  const Lanes3 p = in_shape(solid, points);
  const auto in_body = [&](const Lanes3& n) { return product(solid.body_from_shape.linear(), n); };
  switch (solid.kind) {
    case ShapeKind::sphere:
      return in_body(direction(p));
    case ShapeKind::capsule:
      return in_body(direction(from_axis(p, solid.size_m[1])));
    case ShapeKind::cylinder:
      return in_body(cylinder_normal(solid.size_m, p));
    case ShapeKind::box:
      break;
  }
  return in_body(box_normal(solid.size_m, p));
}

Distance distance(const Solid& solid, const Vector3d& point) {
  const Lanes3 points = Lanes3::all(point);
  return {distance_m(solid, points)[0], normal(solid, points).at(0)};
}

Distance distance(const ObjectSpec& object, const Vector3d& point) {
  const Solid& nearest = *std::ranges::min_element(object.solids, {}, [&](const Solid& solid) {
    return distance_m(solid, Lanes3::all(point))[0];
  });
  return distance(nearest, point);
}

double distance_m(const ObjectSpec& object, const Vector3d& point) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Solid& solid : object.solids)
    nearest_m = std::min(nearest_m, distance_m(solid, Lanes3::all(point))[0]);
  return nearest_m;
}

Solid capsule_between(const Vector3d& a_m, const Vector3d& b_m, double radius_m,
                      const Vector3d& color) {
  Solid solid{ShapeKind::capsule,
              {radius_m, 0.5 * (b_m - a_m).norm(), 0.0},
              Eigen::Isometry3d::Identity(),
              color};
  solid.body_from_shape.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), b_m - a_m).toRotationMatrix();
  solid.body_from_shape.translation() = 0.5 * (a_m + b_m);
  return solid;
}

double bounding_radius_m(const Solid& solid) {
  const Vector3d& size = solid.size_m;
  const double centre = solid.body_from_shape.translation().norm();
  switch (solid.kind) {
    case ShapeKind::sphere:
      return centre + size[0];
    case ShapeKind::capsule:
      return centre + size[0] + size[1];
    case ShapeKind::cylinder:
      return centre + std::hypot(size[0], size[1]);
    case ShapeKind::box:
      break;
  }
  return centre + size.norm();
}

double bounding_radius_m(const ObjectSpec& object) {
  double radius = 0.0;
  for (const Solid& solid : object.solids) radius = std::max(radius, bounding_radius_m(solid));
  return radius;
}

}  // namespace touchtrace::scene
