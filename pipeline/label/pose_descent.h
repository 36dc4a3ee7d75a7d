#pragma once

#include "pipeline/label/body_fit.h"

namespace touchtrace::label {

/// What is known of a pose before it is fitted: one point's worth of its place, and its rotation.
struct PosePrior {
  Eigen::Isometry3d start;
  double rotation_sigma_rad;
};

/// At most `most_steps` of Levenberg and Marquardt from the prior's start, with a loss of one
/// width.
BodyFit descend(const BodyView& view, const RoundedBody& body, const PosePrior& prior,
                double loss_width_m, int most_steps);

}  // namespace touchtrace::label
