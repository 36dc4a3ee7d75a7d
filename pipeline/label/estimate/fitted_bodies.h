#pragma once

#include <vector>

#include "pipeline/label/estimate/body_fit.h"

namespace touchtrace::label {

/// Body fitted to all views of shape learning.
struct FittedBody {
  RoundedBody body;
  std::vector<BodyFit> fits;  ///< of the views
  double cost_m2 = 0.0;       ///< of all views and of compactness
  double box_cost_m2 = 0.0;   ///< part of the box planes
};
using FittedBodies = std::vector<FittedBody>;

/// The bodies that the one of smallest cost does not refute; there must be one. Points of one view
/// err together, so the views are the independent observations; so are the sides of boxes. What
/// lies behind the visible side is free: the front of a bar also fits a plank with a rounded edge.
FittedBodies plausible_of(const FittedBodies& bodies);

/// The body with the smallest bounding box.
FittedBody smallest_of(const FittedBodies& bodies);

/// The body whose half extents are nearest to the medians. Half extents are compared by size.
FittedBody typical_of(const FittedBodies& bodies);

/// RMS difference of the half extents from those of `learnt`, over bodies and axes.
double half_extent_spread_m(const FittedBodies& bodies, const FittedBody& learnt);

}  // namespace touchtrace::label
