#pragma once

#include <vector>

#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about `center_m`
};

/// Of a homogeneous solid of 1 kg/m^3, in the frame that carries it: the volume as the mass. With
/// `wall_m` > 0 only its wall, that thick, is there.
MassProperties volume_properties(const Solid& solid, double wall_m);

/// The same of `density` times as much.
MassProperties scaled(const MassProperties& properties, double density);

/// Of several bodies that are rigidly joined, by the parallel axis theorem; those that overlap
/// count twice where they do. There must be some mass.
MassProperties joined(const std::vector<MassProperties>& parts);

}  // namespace touchtrace::scene
