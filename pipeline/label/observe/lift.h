#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Visible surface of a body in one frame [colour camera's frame].
struct Patch {
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3f> points_m;
  PixelBox box;           ///< bounding box of the points' pixels
  double likeness = 0.0;  ///< mean over the points
};

/// Radius of a disc with a hand's visible area.
inline constexpr double hand_disc_radius_m = 0.05;
/// Minimum visible fraction of that disc for a hand; a sleeve's edge has less.
inline constexpr double min_hand_fraction = 0.07;
/// Radius of the ball that contains a hand's patch, and that of an object over its own radius.
inline constexpr double hand_patch_radius_m = 0.12, object_patch_radius_factor = 1.6;

/// Finds the densest ball of `radius_m` with points of `body` by mean shift from `start_m`. Returns
/// nullopt if it has fewer than `min_points`.
std::optional<Patch> find_patch(const Surface& surface, Body body, const Eigen::Vector3d& start_m,
                                double radius_m, std::size_t min_points);

/// Reach of a hand from where it was last seen.
inline constexpr double arm_reach_m = 0.7;

/// Rank of a patch among others of its class: by its number of points and its distance from where
/// it is expected, over the distance scale.
inline double patch_score(double num_points, double relative_distance) {
  return std::log(num_points) - 8.0 * relative_distance * relative_distance;
}

/// Per-axis median of the points of `body` within `gate_m` of `centre_m`, or nullopt: a start for
/// find_patch.
std::optional<Eigen::Vector3d> median_point(const Surface& surface, Body body,
                                            const Eigen::Vector3d& centre_m, double gate_m);

/// Radius [m] of a disc whose points have the patch's extent across the line of sight, along the
/// wider image axis. Uses the middle 80 % of the points, which excludes outliers.
double silhouette_radius_m(const Patch& patch);

}  // namespace touchtrace::label
