#include "pipeline/label/rounded_body.h"

#include <cmath>

namespace touchtrace::label {
namespace {

constexpr int halvings = 9;  // of the stretch within the bounding sphere: to some 0.1 mm

/// The part of a segment, 0..1, that lies within a sphere about the origin; where it passes by, the
/// nearest point twice.
std::pair<double, double> within_sphere(const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                                        double radius) {
  const double square = along.squaredNorm();
  const double middle = -from.dot(along) / square;
  const double off2 = (from + middle * along).squaredNorm();
  const double half = std::sqrt(std::max(0.0, (radius * radius - off2) / square));
  return {std::clamp(middle - half, 0.0, 1.0), std::clamp(middle + half, 0.0, 1.0)};
}

SurfaceDistance from_box(const RoundedBody& body, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d beyond = point_m.cwiseAbs() - body.inner_m;
  const Eigen::Vector3d sign = point_m.unaryExpr([](double v) { return v < 0.0 ? -1.0 : 1.0; });
  Eigen::Index axis;
  if (const double most = beyond.maxCoeff(&axis); most <= 0.0)
    return {most - body.radius_m, sign[axis] * Eigen::Vector3d::Unit(axis)};
  const Eigen::Vector3d out = beyond.cwiseMax(0.0);
  const double norm = out.norm();
  return {norm - body.radius_m, out.cwiseProduct(sign) / norm};
}

}  // namespace

SurfaceDistance surface_distance(const RoundedBody& body, const Eigen::Vector3d& point_m) {
  if (body.core == Core::box) return from_box(body, point_m);
  const Eigen::Vector3d seen = in_section(body.core, point_m);
  auto surface = from_box(body, seen);
  const Eigen::Vector2d off(point_m.x() + beside_axis_m, point_m.y());
  surface.outward.head<2>() = surface.outward.x() / seen.x() * off;
  return surface;
}

double turn_to_see_rad(Core core, const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::Array4d part = (from.conjugate() * to).coeffs().array().abs();  // x y z w
  const double same = core == Core::box
                          ? part.maxCoeff()
                          : std::max(std::hypot(part[2], part[3]), std::hypot(part[0], part[1]));
  return 2.0 * std::acos(std::min(1.0, same));
}

std::optional<Eigen::Vector3d> deepest_point(const RoundedBody& body, const Eigen::Vector3d& from_m,
                                             const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d along = to_m - from_m;
  const double length = along.norm();
  auto [near, far] = within_sphere(from_m, along, body.circumradius_m());
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (near + far);
    const auto here = surface_distance(body, from_m + middle * along);
    if (here.distance_m > (far - middle) * length) return std::nullopt;
    (here.outward.dot(along) > 0.0 ? far : near) = middle;
  }
  return from_m + 0.5 * (near + far) * along;
}

}  // namespace touchtrace::label
