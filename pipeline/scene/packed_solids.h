#pragma once

#include <vector>

#include "pipeline/scene/renderer.h"

namespace touchtrace::scene {

/// Solids as kernels/solids.clh reads them.
inline constexpr int packed_solid_floats = 28;
inline constexpr std::size_t max_solids = 96;

/// x' low, high, y' low, high of everything a ray may hit of a solid; unbounded if it reaches
/// behind the camera.
std::array<float, 4> projected_bounds(const Solid& solid,
                                      const Eigen::Isometry3d& camera_from_world);

/// [instants, solids, packed_solid_floats], near solids first, with bounds that span all instants.
/// Throws failure if there are more than max_solids.
std::vector<float> pack_solids(const std::vector<std::vector<PaintedSolid>>& instants,
                               const Eigen::Isometry3d& camera_from_world);

}  // namespace touchtrace::scene
