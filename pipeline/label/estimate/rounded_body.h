#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace touchtrace::label {

enum class Core { box, cylinder };

/// Box or cylinder with rounded edges: all points within `radius_m` of its core (Minkowski sum of
/// core and ball). Spheres, capsules and slabs are special cases.
struct RoundedBody {
  /// Half extents of the core in the body frame. A cylinder's axis is z; x and y are its radius.
  Eigen::Vector3d inner_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;  ///< of the edges; positive
  Core core = Core::box;

  Eigen::Vector3d half_extents_m() const { return inner_m.array() + radius_m; }
  double circumradius_m() const { return farthest_core_point_m().norm() + radius_m; }

 private:
  Eigen::Vector3d farthest_core_point_m() const {
    return core == Core::box ? inner_m : Eigen::Vector3d(inner_m.x(), 0.0, inner_m.z());
  }
};

struct SurfaceDistance {
  double distance_m;        ///< signed, negative inside
  Eigen::Vector3d outward;  ///< its gradient, a unit vector
};
/// Distance of a point to the surface; body frame.
SurfaceDistance surface_distance(const RoundedBody& body, const Eigen::Vector3d& point_m);

/// Support point of the core: its farthest point in a direction; body frame.
Eigen::Vector3d core_support_point(Core core, const Eigen::Vector3d& direction,
                                   const Eigen::Vector3d& inner_m);

/// Signed distance by which a body extends beyond a plane through the camera's centre with unit
/// normal `outward` (camera frame).
double extent_beyond_plane_m(const RoundedBody& body, const Eigen::Isometry3d& camera_from_body,
                             const Eigen::Vector3d& outward);

/// Smallest angle [rad] between two orientations of a body up to its symmetries: half turns of a
/// box about its axes; any turn of a cylinder about its axis and half turns perpendicular to it.
double symmetric_rotation_distance(Core core, const Eigen::Quaterniond& from,
                                   const Eigen::Quaterniond& to);

/// Point of a segment that is deepest inside the body, to about 0.1 mm; body frame. Returns nullopt
/// if the segment misses the body. Unique because the distance along a line is convex.
std::optional<Eigen::Vector3d> deepest_point(const RoundedBody& body, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m);

}  // namespace touchtrace::label
