#include "pipeline/scene/objects/mass.h"

#include <cmath>
#include <numbers>

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

/// Volume [m^3] and second moments [m^5] about the principal axes of a filled shape.
struct Moments {
  double volume;
  Vector3d moments;
};

Moments operator-(const Moments& a, const Moments& b) {
  return {a.volume - b.volume, a.moments - b.moments};
}

Moments cylinder_moments(double radius, double half_length) {
  const double volume = 2 * pi * radius * radius * half_length;
  const double across = radius * radius / 4 + half_length * half_length / 3;
  return {volume, volume * Vector3d(across, across, radius * radius / 2)};
}

/// A cylinder with a half sphere at each end.
Moments capsule_moments(double radius, double half_length) {
  const Moments middle = cylinder_moments(radius, half_length);
  const double ends = 4.0 / 3 * pi * radius * radius * radius;
  const double along = 0.4 * radius * radius;
  const double across = along + half_length * half_length + 0.75 * half_length * radius;
  return {middle.volume + ends, middle.moments + ends * Vector3d(across, across, along)};
}

Moments shape_moments(ShapeKind kind, const Vector3d& size) {
  switch (kind) {
    case ShapeKind::sphere:
      return capsule_moments(size[0], 0.0);
    case ShapeKind::capsule:
      return capsule_moments(size[0], size[1]);
    case ShapeKind::cylinder:
      return cylinder_moments(size[0], size[1]);
    case ShapeKind::box:
      break;
  }
  const double volume = 8 * size.prod();
  return {volume, volume / 3 * (Vector3d::Constant(size.squaredNorm()) - size.cwiseAbs2())};
}

/// Size of the cavity inside a wall. A capsule's straight part keeps its length.
Vector3d inner_size(ShapeKind kind, const Vector3d& size, double wall_m) {
  if (kind == ShapeKind::box) return size - Vector3d::Constant(wall_m);
  return {size[0] - wall_m, kind == ShapeKind::cylinder ? size[1] - wall_m : size[1], 0.0};
}

}  // namespace

MassProperties volume_properties(const Solid& solid, double wall_m) {
  Moments m = shape_moments(solid.kind, solid.size_m);
  if (wall_m > 0.0) m = m - shape_moments(solid.kind, inner_size(solid.kind, solid.size_m, wall_m));
  const Matrix3d turn = solid.body_from_shape.linear();
  return {m.volume, solid.body_from_shape.translation(),
          turn * m.moments.asDiagonal() * turn.transpose()};
}

MassProperties scaled(const MassProperties& properties, double density) {
  return {density * properties.mass_kg, properties.center_m, density * properties.inertia_kg_m2};
}

MassProperties combined(const std::vector<MassProperties>& parts) {
  MassProperties whole;
  for (const MassProperties& part : parts) {
    whole.mass_kg += part.mass_kg;
    whole.center_m += part.mass_kg * part.center_m;
  }
  whole.center_m /= whole.mass_kg;
  for (const MassProperties& part : parts) {
    const Vector3d arm = part.center_m - whole.center_m;
    whole.inertia_kg_m2 +=
        part.inertia_kg_m2 +
        part.mass_kg * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
  }
  return whole;
}

}  // namespace touchtrace::scene
