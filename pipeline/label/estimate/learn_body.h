#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

namespace touchtrace::label {

struct LearntBody {
  RoundedBody body;
  /// Standard deviation of the half extents, RMS over the axes: from noise, and from the other
  /// bodies that the views do not refute. A wrong extent shifts the centre of a body seen from one
  /// side.
  double half_extent_sigma_m;
};

/// Learns the rounded box or cylinder that fits all views of a rigid body best, with one pose per
/// view (ShapeProblem). The size of the start shapes is `radius_m` or that of the boxes, whichever
/// is larger. Extents that nothing constrains stay small; box planes constrain parts that are
/// hidden in all views. Requires views, each with surface points. `num_threads` 0: one per core.
LearntBody learn_body(const std::vector<BodyView>& views, double radius_m, int num_threads);

}  // namespace touchtrace::label
