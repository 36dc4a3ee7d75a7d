#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace touchtrace::label {

enum class Core { box, cylinder };

/// A box or a cylinder with rounded edges: all points within `radius_m` of its core. A sphere, a
/// capsule and a slab are among them.
struct RoundedBody {
  /// Half extents of the core along the body's axes; a cylinder's axis is z, and the other two are
  /// its radius.
  Eigen::Vector3d inner_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;  ///< of its edges; more than 0
  Core core = Core::box;

  Eigen::Vector3d half_extents_m() const { return inner_m.array() + radius_m; }
  double circumradius_m() const { return core_point_m().norm() + radius_m; }

 private:
  /// The farthest of the core.
  Eigen::Vector3d core_point_m() const {
    return core == Core::box ? inner_m : Eigen::Vector3d(inner_m.x(), 0.0, inner_m.z());
  }
};

/// On the axis of a cylinder no direction is outward: nothing is quite there.
inline constexpr double beside_axis_m = 1e-15;

/// A point as the core's section through it sees it: that of a cylinder is a box of no thickness.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> in_section(Core core, const Eigen::Matrix<Scalar, 3, 1>& point) {
  using std::sqrt;
  if (core == Core::box) return point;
  const Scalar x = point.x() + beside_axis_m;
  return {sqrt(x * x + point.y() * point.y()), Scalar(0.0), point.z()};
}

/// Signed distance [m] of a point from the surface of a rounded body, negative within; body frame.
/// For any scalar, so that solvers differentiate it.
template <class Scalar>
Scalar distance_from_body(Core core, const Eigen::Matrix<Scalar, 3, 1>& point,
                          const Eigen::Matrix<Scalar, 3, 1>& inner, const Scalar& radius) {
  using std::abs, std::sqrt;
  const Scalar zero(0.0);
  const auto seen = in_section(core, point);
  const Scalar x = abs(seen.x()) - inner.x(), y = abs(seen.y()) - inner.y(),
               z = abs(seen.z()) - inner.z();
  if (!(x > zero) && !(y > zero) && !(z > zero)) return std::max(x, std::max(y, z)) - radius;
  Scalar square(0.0);
  for (const Scalar& beyond : {x, y, z})
    if (beyond > zero) square += beyond * beyond;
  return sqrt(square) - radius;
}

/// The same with the unit vector in which it grows.
struct SurfaceDistance {
  double distance_m;
  Eigen::Vector3d outward;
};
SurfaceDistance surface_distance(const RoundedBody& body, const Eigen::Vector3d& point_m);

/// The point of the core that is farthest in a direction; body frame. For any scalar.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 1> farthest_of_core(Core core, const Eigen::Matrix<Scalar, 3, 1>& toward,
                                             const Eigen::Matrix<Scalar, 3, 1>& inner) {
  using std::sqrt;
  Eigen::Matrix<Scalar, 3, 1> point;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[axis] = toward[axis] < Scalar(0.0) ? Scalar(-inner[axis]) : inner[axis];
  if (core == Core::box) return point;
  const Scalar x = toward.x() + beside_axis_m, y = toward.y(), across = sqrt(x * x + y * y);
  point.x() = inner.x() * x / across, point.y() = inner.x() * y / across;
  return point;
}

/// The angle between two rotations of a body as it looks: half turns of a box about its axes, and
/// any turn of a cylinder about its own or half a turn across that, cannot be seen.
double turn_to_see_rad(Core core, const Eigen::Quaterniond& from, const Eigen::Quaterniond& to);

/// The point of the segment from `from_m` to `to_m` that is deepest in the body; body frame.
/// Nothing if it passes by. Distance along a line is convex, so that there is one.
std::optional<Eigen::Vector3d> deepest_point(const RoundedBody& body, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m);

}  // namespace touchtrace::label
