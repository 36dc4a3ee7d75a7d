#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// A body's visible surface, gathered from one frame.
struct Patch {
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3f> points_m;
  PixelBox box;  ///< around the points' pixels
};

/// What belongs to a hand, and to an object in terms of its radius.
inline constexpr double hand_patch_radius_m = 0.12, object_patch_radii = 1.6;

/// The points of `body` in the densest place near `start_m`: mean shift with a ball of `radius_m`.
/// Nothing if fewer than `fewest` points lie in it.
std::optional<Patch> find_patch(const Surface& surface, Body body, const Eigen::Vector3d& start_m,
                                double radius_m, std::size_t fewest);

/// Where to start when only a region is known: the median of the points of `body` within `gate_m`
/// of `center_m`, or nothing.
std::optional<Eigen::Vector3d> median_point(const Surface& surface, Body body,
                                            const Eigen::Vector3d& center_m, double gate_m);

/// Radius [m] of the disc whose points spread across the line of sight as the patch's do along its
/// longer axis: by the middle 80 %, so that stray points do not count.
double silhouette_radius_m(const Patch& patch);

}  // namespace touchtrace::label
