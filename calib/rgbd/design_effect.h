#pragma once

#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Kish's design effect: how much more a sum of samples varies than that of independent ones,
/// because neighbouring depth pixels share noise. 1 unless the data show more than chance would.
struct DesignEffect {
  double planes =
      1.0;  ///< of the plane fitted to a view's residuals; also grows with errors of the poses
  double tiles = 1.0;  ///< of 4x4 tiles a view, after that plane was taken out
};

/// `normalized`: the samples' residuals, divided by their deviation.
DesignEffect design_effect(const std::vector<DepthSample>& samples,
                           const std::vector<double>& normalized);

}  // namespace touchtrace
