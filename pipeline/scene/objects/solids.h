#pragma once

#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

/// Signed distance to a surface, negative inside, and the surface's outward normal there.
struct Distance {
  double value_m;
  Eigen::Vector3d normal;
};

/// Signed distances and outward normals of one point per lane, in the solid's body frame. Exact,
/// except that outside of a box's edge or corner the normal is the direction from the nearest
/// point.
Lanes distance_m(const Solid& solid, const Lanes3& points);
Lanes3 normal(const Solid& solid, const Lanes3& points);

Distance distance(const Solid& solid, const Eigen::Vector3d& point);

/// Distance to the union of the object's solids; `point` in the object's body frame.
Distance distance(const ObjectSpec& object, const Eigen::Vector3d& point);
double distance_m(const ObjectSpec& object, const Eigen::Vector3d& point);

/// Capsule whose axis is the segment from `a_m` to `b_m`.
Solid capsule_between(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, double radius_m,
                      const Eigen::Vector3d& color);

/// Radius of a sphere around the body frame's origin that encloses the solid.
double bounding_radius_m(const Solid& solid);
double bounding_radius_m(const ObjectSpec& object);

}  // namespace touchtrace::scene
