#pragma once

#include "pipeline/label/body_fit.h"

namespace touchtrace::label {

/// What is known of a pose before it is fitted.
struct PosePrior {
  Eigen::Isometry3d start;
  double rotation_sigma_rad;
  double place_points = 1.0;  ///< how many points its place is worth
};

/// At most `most_steps` of Levenberg and Marquardt from the prior's start, with a loss of one
/// width for points and rays.
BodyFit descend(const BodyView& view, const RoundedBody& body, const PosePrior& prior,
                double loss_width_m, int most_steps);

}  // namespace touchtrace::label
