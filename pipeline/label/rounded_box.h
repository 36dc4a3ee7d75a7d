#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

namespace touchtrace::label {

/// A box with rounded edges: all points within `radius_m` of a box of half extents `inner_m`. A
/// sphere, a capsule and a slab are among them, and it stands for a cylinder or an egg well enough.
struct RoundedBox {
  Eigen::Vector3d inner_m = Eigen::Vector3d::Zero();  ///< half extents along the body's axes
  double radius_m = 0.0;                              ///< of its edges; more than 0

  Eigen::Vector3d half_extents_m() const { return inner_m.array() + radius_m; }
  double circumradius_m() const { return inner_m.norm() + radius_m; }
};

/// Signed distance [m] of a point from the surface of a rounded box, negative within; body frame.
/// For any scalar, so that solvers differentiate it.
template <class Scalar>
Scalar distance_from_box(const Eigen::Matrix<Scalar, 3, 1>& point,
                         const Eigen::Matrix<Scalar, 3, 1>& inner, const Scalar& radius) {
  using std::abs, std::sqrt;
  const Scalar zero(0.0);
  const Scalar x = abs(point.x()) - inner.x(), y = abs(point.y()) - inner.y(),
               z = abs(point.z()) - inner.z();
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
SurfaceDistance surface_distance(const RoundedBox& box, const Eigen::Vector3d& point_m);

/// The point of the segment from `from_m` to `to_m` that is deepest in the box; body frame. Nothing
/// if it passes by. Distance along a line is convex, so that there is one.
std::optional<Eigen::Vector3d> deepest_point(const RoundedBox& box, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m);

}  // namespace touchtrace::label
