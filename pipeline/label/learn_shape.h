#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

namespace touchtrace::label {

/// What stands for an object.
struct ObjectShape {
  double radius_m = 0.0;            ///< of the sphere that fits best
  std::optional<RoundedBody> body;  ///< if no sphere stands for it
  /// Deviation of the surface from it: of a sphere beyond the sensor's noise, of a body all of it.
  double unevenness_m = 0.0;
  /// Deviation of its middle from the object's: of a body as far as its surface lies off, and as
  /// its extents are unknown; a sphere leans on what shows of the object, and leaves less
  /// unevenness than it hides.
  double middle_sigma_m = 0.0;

  /// No point of the object is farther than this from its middle.
  double reach_m() const { return body ? body->circumradius_m() : radius_m; }
};

/// The sphere that fits all views best, near that of the silhouette; or a rounded body, if
/// the surface is uneven and it fits much better. There must be views, each with points. The result
/// does not depend on the number of threads.
ObjectShape learn_shape(const std::vector<BodyView>& views, double silhouette_m, int threads);

}  // namespace touchtrace::label
