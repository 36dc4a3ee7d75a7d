#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/scene/scene.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

Solid solid(ShapeKind kind, const Vector3d& size_m, const Vector3d& color) {
  return {kind, size_m, Eigen::Isometry3d::Identity(), color};
}

/// Principal moments of a homogeneous body; a capsule counts as the cylinder of its whole length.
Eigen::Matrix3d inertia(double mass_kg, const Solid& s) {
  const Vector3d half = s.kind == ShapeKind::capsule
                            ? Vector3d(s.size_m[0], s.size_m[0] + s.size_m[1], 0.0)
                            : s.size_m;
  Vector3d moments = Vector3d::Zero();
  switch (s.kind) {
    case ShapeKind::sphere:
      moments.setConstant(0.4 * half[0] * half[0]);
      break;
    case ShapeKind::box:
      moments = Vector3d::Constant(half.squaredNorm() / 3) - half.cwiseAbs2() / 3;
      break;
    case ShapeKind::capsule:
    case ShapeKind::cylinder: {
      const double across = half[0] * half[0] / 4 + half[1] * half[1] / 3;
      moments = {across, across, half[0] * half[0] / 2};
    }
  }
  return mass_kg * moments.asDiagonal();
}

ObjectSpec object(std::string name, double mass_kg, double friction, Solid shape) {
  const Eigen::Matrix3d moments = inertia(mass_kg, shape);
  return {std::move(name), mass_kg, friction, moments, {std::move(shape)}};
}

const std::vector<ObjectSpec>& objects() {
  static const std::vector<ObjectSpec> table{
      object("ball", 0.170, 0.7, solid(ShapeKind::sphere, {0.0286, 0, 0}, {0.85, 0.10, 0.05})),
      object("box", 0.220, 0.6, solid(ShapeKind::box, {0.025, 0.045, 0.022}, {0.90, 0.55, 0.05})),
      object("can", 0.350, 0.6, solid(ShapeKind::cylinder, {0.026, 0.050, 0}, {0.10, 0.60, 0.15})),
      object("bottle", 0.260, 0.7,
             solid(ShapeKind::capsule, {0.024, 0.050, 0}, {0.10, 0.35, 0.85})),
  };
  return table;
}

}  // namespace

std::vector<std::string> object_names() {
  std::vector<std::string> names;
  for (const ObjectSpec& o : objects()) names.push_back(o.name);
  return names;
}

const ObjectSpec& find_object(const std::string& name) {
  for (const ObjectSpec& o : objects())
    if (o.name == name) return o;
  throw usage_error(fmt::format("there is no object '{}'", name), suggestion(name, object_names()));
}

}  // namespace touchtrace::scene
