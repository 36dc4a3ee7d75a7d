#pragma once

#include "pipeline/label/estimate/body_fit.h"

namespace touchtrace::label {

/// Gaussian prior of a pose, about its start. Its cost is not robust.
struct PosePrior {
  Eigen::Isometry3d start;  ///< camera_from_body
  double rotation_sigma_rad;
  double position_weight = 1.0;  ///< weight of the squared offset [m^2]; a surface point has 1
};

/// Minimises the cost of BodyView plus the prior over the pose, from the prior's start: at most
/// `max_steps` steps of Levenberg-Marquardt.
BodyFit optimize_pose(const BodyView& view, const RoundedBody& body, const PosePrior& prior,
                      double loss_width_m, int max_steps);

}  // namespace touchtrace::label
