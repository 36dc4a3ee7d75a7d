#pragma once

#include <vector>

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

inline constexpr int packed_solid_floats = 96;  ///< per solid; layout: kernels/solids.clh
inline constexpr std::size_t max_solids = 96;

/// Bounds of the rays that may hit a solid: x' and y' in the camera's frame at z' = 1, and the
/// smallest depth. Initially empty.
struct SolidBounds {
  float x_low = 1e9f, x_high = -1e9f, y_low = 1e9f, y_high = -1e9f, nearest_m = 1e9f;

  void include(const Eigen::Vector3d& point);
  void include(const SolidBounds& other);
};

/// Bounds of the part of the solid's bounding box that is before the camera.
SolidBounds projected_bounds(const Solid& solid, const Eigen::Isometry3d& camera_from_world);

/// Returns [instants, solids, packed_solid_floats], sorted by depth, with bounds over all instants.
/// `lamp` is the direction to the lamp, world frame. Throws failure for more than max_solids.
std::vector<float> pack_solids(const std::vector<std::vector<PaintedSolid>>& instants,
                               const Eigen::Isometry3d& camera_from_world,
                               const Eigen::Vector3d& lamp);

}  // namespace touchtrace::scene
