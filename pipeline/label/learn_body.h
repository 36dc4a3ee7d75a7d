#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

namespace touchtrace::label {

/// A shape, and the deviations of its half extents by noise and by what nothing shows: where one is
/// wrong, so is the middle of what is seen from one side.
struct LearntBody {
  RoundedBody body;
  Eigen::Vector3d half_extent_sigma_m;
};

/// The rounded box or cylinder that fits all views of a rigid body best, each view with a pose of
/// its own: a robust Ceres problem, started from a sphere of `radius_m`, or as large as the marked
/// boxes, drawn out. Extents that nothing shows stay small; marked sides show what is hidden in
/// all views. There must be views, each with points.
LearntBody learn_body(const std::vector<BodyView>& views, double radius_m, int threads);

}  // namespace touchtrace::label
