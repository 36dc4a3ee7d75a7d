#pragma once

#include <vector>

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

/// Solids as kernels/solids.clh reads them.
inline constexpr int packed_solid_floats = 96;
inline constexpr std::size_t max_solids = 96;

/// What rays may hit of a solid: their x' and y' (camera's frame, z' = 1), and the least depth.
/// Empty until something is included.
struct SolidBounds {
  float x_low = 1e9f, x_high = -1e9f, y_low = 1e9f, y_high = -1e9f, nearest_m = 1e9f;

  void include(const Eigen::Vector3d& point);
  void include(const SolidBounds& other);
};

/// Of the part of the solid's bounding box that is before the camera.
SolidBounds projected_bounds(const Solid& solid, const Eigen::Isometry3d& camera_from_world);

/// [instants, solids, packed_solid_floats], near solids first, with bounds that span all instants.
/// `lamp` is the direction to it, in the world. Throws failure if there are more than max_solids.
std::vector<float> pack_solids(const std::vector<std::vector<PaintedSolid>>& instants,
                               const Eigen::Isometry3d& camera_from_world,
                               const Eigen::Vector3d& lamp);

}  // namespace touchtrace::scene
