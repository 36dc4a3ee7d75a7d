#pragma once

#include <Eigen/Geometry>
#include <algorithm>
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

/// Offset that keeps points off a cylinder's axis, where the gradient is undefined.
inline constexpr double axis_offset_m = 1e-15;

/// Maps a point to the half-plane through the cylinder's axis, in which the cylinder is a box of
/// zero thickness. Identity for a box.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> to_section(Core core, const Eigen::Matrix<Scalar, 3, 1>& point) {
  using std::sqrt;
  if (core == Core::box) return point;
  const Scalar x = point.x() + axis_offset_m;
  return {sqrt(x * x + point.y() * point.y()), Scalar(0.0), point.z()};
}

/// Signed distance [m] of a point to the surface, negative inside; body frame. `Scalar` may be a
/// ceres::Jet.
template <class Scalar>
Scalar distance_from_body(Core core, const Eigen::Matrix<Scalar, 3, 1>& point,
                          const Eigen::Matrix<Scalar, 3, 1>& inner, const Scalar& radius) {
  using std::abs, std::sqrt;
  const Scalar zero(0.0);
  const auto section = to_section(core, point);
  const Scalar x = abs(section.x()) - inner.x(), y = abs(section.y()) - inner.y(),
               z = abs(section.z()) - inner.z();
  if (!(x > zero) && !(y > zero) && !(z > zero)) return std::max(x, std::max(y, z)) - radius;
  Scalar square(0.0);
  for (const Scalar& outside : {x, y, z})
    if (outside > zero) square += outside * outside;
  return sqrt(square) - radius;
}

struct SurfaceDistance {
  double distance_m;        ///< signed, negative inside
  Eigen::Vector3d outward;  ///< its gradient, a unit vector
};
/// distance_from_body with its gradient; body frame.
SurfaceDistance surface_distance(const RoundedBody& body, const Eigen::Vector3d& point_m);

/// Support point of the core: its farthest point in a direction; body frame. `Scalar` may be a
/// ceres::Jet.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> core_support_point(Core core,
                                               const Eigen::Matrix<Scalar, 3, 1>& direction,
                                               const Eigen::Matrix<Scalar, 3, 1>& inner) {
  using std::sqrt;
  Eigen::Matrix<Scalar, 3, 1> point;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[axis] = direction[axis] < Scalar(0.0) ? Scalar(-inner[axis]) : inner[axis];
  if (core == Core::box) return point;
  const Scalar x = direction.x() + axis_offset_m, y = direction.y(), radial = sqrt(x * x + y * y);
  point.x() = inner.x() * x / radial, point.y() = inner.x() * y / radial;
  return point;
}

/// Smallest angle [rad] between two orientations of a body up to its symmetries: half turns of a
/// box about its axes; any turn of a cylinder about its axis and half turns perpendicular to it.
double symmetric_rotation_distance(Core core, const Eigen::Quaterniond& from,
                                   const Eigen::Quaterniond& to);

/// Point of a segment that is deepest inside the body, to about 0.1 mm; body frame. Returns nullopt
/// if the segment misses the body. Unique because the distance along a line is convex.
std::optional<Eigen::Vector3d> deepest_point(const RoundedBody& body, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m);

}  // namespace touchtrace::label
