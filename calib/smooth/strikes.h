#pragma once

#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Decides which down-weighted measurements are strikes, whose short accelerations look like
/// outliers, and sets their weights to 1 for good (`WeightedTrack::in_strike`). `noise` is the
/// tracks' noise, the curves and weights are those estimated with it.
void find_strikes(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                  const SmoothOptions& options);

}  // namespace touchtrace
