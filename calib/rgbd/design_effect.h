#pragma once

#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Kish's design effect: how much more the mean over a tile of samples varies than that of
/// independent ones, because neighbouring depth pixels share noise. `normalized`: residuals of unit
/// variance.
///
/// Tiles are 4x4 a view; each view's plane is fitted and taken out first, because an error of the
/// board's pose is not noise of the depth. 1 unless the data show more than chance would.
double design_effect(const std::vector<DepthSample>& samples,
                     const std::vector<double>& normalized);

}  // namespace touchtrace
