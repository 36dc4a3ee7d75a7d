#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

namespace touchtrace::label {

/// Geometric model of an object.
struct ObjectShape {
  double radius_m = 0.0;            ///< of the best-fitting sphere
  std::optional<RoundedBody> body;  ///< empty: the sphere is the model
  /// Robust standard deviation of the points' distances from the model's surface; for a sphere,
  /// without the sensor's noise.
  double unevenness_m = 0.0;
  /// Standard deviation along an axis of the model's centre about the object's. Body: from
  /// unevenness and the uncertainty of its extents. Sphere: from unevenness; larger than it, since
  /// the fit leans towards the visible side.
  double centre_sigma_m = 0.0;

  /// Largest distance of a surface point from the centre.
  double reach_m() const { return body ? body->circumradius_m() : radius_m; }
};

/// Learns an object's shape from its views. Fits a sphere, with a radius near `silhouette_m`.
/// Replaces it by a rounded body if the surface is uneven and the body fits much better. Requires
/// views, each with surface points. The result does not depend on `num_threads` (0: one per core).
ObjectShape learn_shape(const std::vector<BodyView>& views, double silhouette_m, int num_threads);

/// ObjectShape::centre_sigma_m of a learnt sphere of whose disc `fraction` is visible. A cap of an
/// ellipsoid deviates from a sphere by the fourth power of its width, so that little unevenness of
/// a small cap does not mean a sphere. The difference of the radius of its curvature from that of
/// the boxes is about the error of the centre.
double hidden_sphere_centre_sigma_m(const ObjectShape& sphere, double fraction,
                                    double box_radius_m);

}  // namespace touchtrace::label
