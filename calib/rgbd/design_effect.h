#pragma once

#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Kish's design effect: variance of a sum of samples over that of independent samples. Above 1
/// because neighbouring depth pixels share noise. 1 unless the excess is significant.
struct DesignEffect {
  double planes = 1.0;  ///< from the plane fitted to each view's residuals; includes pose errors
  double tiles = 1.0;   ///< from 4x4 tiles of each view, after subtracting that plane
};

/// `normalized`: residuals of the samples over their standard deviation.
DesignEffect design_effect(const std::vector<DepthSample>& samples,
                           const std::vector<double>& normalized);

}  // namespace touchtrace
