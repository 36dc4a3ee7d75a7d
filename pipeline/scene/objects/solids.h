#pragma once

#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/objects/object.h"

namespace touchtrace::scene {

/// How far a point lies outside of a surface (negative inside), and the surface's outward normal
/// there.
struct Distance {
  double value_m;
  Eigen::Vector3d normal;
};

/// Of as many points as there are lanes, in the frame of the body that carries the solid. Exact
/// outside and inside, except that near a box's edges outside the normal is that of the nearest
/// point.
Lanes distance_m(const Solid& solid, const Lanes3& points);
Lanes3 normal(const Solid& solid, const Lanes3& points);

/// The same of one point.
Distance distance(const Solid& solid, const Eigen::Vector3d& point);

/// Of the union of the object's solids; `point` in the object's body frame.
Distance distance(const ObjectSpec& object, const Eigen::Vector3d& point);
double distance_m(const ObjectSpec& object, const Eigen::Vector3d& point);

/// Of a sphere around the origin of the body frame that holds the solid.
double bounding_radius_m(const Solid& solid);
double bounding_radius_m(const ObjectSpec& object);

}  // namespace touchtrace::scene
