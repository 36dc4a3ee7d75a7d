#include "pipeline/scene/objects/solids.h"

#include <algorithm>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

/// Of a point at `offset` from the nearest point of a skeleton, with the skin `radius` away.
Distance from_skeleton(const Vector3d& offset, double radius) {
  const double length = offset.norm();
  return {length - radius, length > 0.0 ? Vector3d(offset / length) : Vector3d::UnitZ()};
}

Distance box_distance(const Vector3d& half, const Vector3d& p) {
  const Vector3d excess = p.cwiseAbs() - half;
  const Vector3d outside = excess.cwiseMax(0.0);
  const Vector3d sign = p.unaryExpr([](double x) { return x < 0.0 ? -1.0 : 1.0; });
  if (const double length = outside.norm(); length > 0.0)
    return {length, outside.cwiseProduct(sign) / length};
  int face;
  const double depth = excess.maxCoeff(&face);
  return {depth, sign[face] * Vector3d::Unit(face)};
}

Distance cylinder_distance(double radius, double half_length, const Vector3d& p) {
  const double rho = std::hypot(p.x(), p.y());
  const Vector3d radial = rho > 0.0 ? Vector3d(p.x() / rho, p.y() / rho, 0.0) : Vector3d::UnitX();
  const Vector3d axial(0.0, 0.0, p.z() < 0.0 ? -1.0 : 1.0);
  const double side = rho - radius, end = std::abs(p.z()) - half_length;
  if (side > 0.0 && end > 0.0) return from_skeleton(side * radial + end * axial, 0.0);
  return side > end ? Distance{side, radial} : Distance{end, axial};
}

double shape_distance_m(const Solid& solid, const Vector3d& p) {
  const Vector3d& size = solid.size_m;
  switch (solid.kind) {
    case ShapeKind::sphere:
      return p.norm() - size[0];
    case ShapeKind::capsule:
      return (p - std::clamp(p.z(), -size[1], size[1]) * Vector3d::UnitZ()).norm() - size[0];
    case ShapeKind::cylinder: {
      const double side = std::sqrt(p.x() * p.x() + p.y() * p.y()) - size[0];
      const double end = std::abs(p.z()) - size[1];
      return side > 0.0 && end > 0.0 ? std::sqrt(side * side + end * end) : std::max(side, end);
    }
    case ShapeKind::box:
      break;
  }
  const Vector3d excess = p.cwiseAbs() - size;
  const double depth = excess.maxCoeff();
  return depth > 0.0 ? excess.cwiseMax(0.0).norm() : depth;
}

Distance shape_distance(const Solid& solid, const Vector3d& p) {
  const Vector3d& size = solid.size_m;
  switch (solid.kind) {
    case ShapeKind::sphere:
      return from_skeleton(p, size[0]);
    case ShapeKind::capsule:
      return from_skeleton(p - std::clamp(p.z(), -size[1], size[1]) * Vector3d::UnitZ(), size[0]);
    case ShapeKind::cylinder:
      return cylinder_distance(size[0], size[1], p);
    case ShapeKind::box:
      break;
  }
  return box_distance(size, p);
}

Vector3d in_shape(const Solid& solid, const Vector3d& point) {
  return solid.body_from_shape.linear().transpose() * (point - solid.body_from_shape.translation());
}

}  // namespace

Distance distance(const Solid& solid, const Vector3d& point) {
  const auto rotation = solid.body_from_shape.linear();
  const Distance d = shape_distance(solid, in_shape(solid, point));
  return {d.value_m, rotation * d.normal};
}

NearestSolid nearest_solid(const ObjectSpec& object, const Vector3d& point) {
  NearestSolid nearest{&object.solids.front(), {}, 0.0};
  nearest.point_in_shape_m = in_shape(*nearest.solid, point);
  nearest.distance_m = shape_distance_m(*nearest.solid, nearest.point_in_shape_m);
  for (std::size_t i = 1; i < object.solids.size(); ++i) {
    const Solid& solid = object.solids[i];
    const Vector3d p = in_shape(solid, point);
    if (const double d = shape_distance_m(solid, p); d < nearest.distance_m)
      nearest = {&solid, p, d};
  }
  return nearest;
}

Vector3d NearestSolid::normal() const {
  return solid->body_from_shape.linear() * shape_distance(*solid, point_in_shape_m).normal;
}

Distance distance(const ObjectSpec& object, const Vector3d& point) {
  const NearestSolid nearest = nearest_solid(object, point);
  return {nearest.distance_m, nearest.normal()};
}

double distance_m(const ObjectSpec& object, const Vector3d& point) {
  return nearest_solid(object, point).distance_m;
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
