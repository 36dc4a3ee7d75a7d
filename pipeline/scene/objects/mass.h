#pragma once

#include <vector>

#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about `center_m`
};

/// Mass properties of a homogeneous solid at 1 kg/m^3, in its body's frame; the mass is the volume.
/// With `wall_m` > 0 only a wall of that thickness has mass.
MassProperties volume_properties(const Solid& solid, double wall_m);

/// Multiplies mass and inertia by `density`.
MassProperties scaled(const MassProperties& properties, double density);

/// Mass properties of rigidly joined parts, by the parallel axis theorem. Overlaps count twice. The
/// total mass must be positive.
MassProperties combined(const std::vector<MassProperties>& parts);

}  // namespace touchtrace::scene
