#pragma once

#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Decides between wrong measurements and short accelerations, which look alike, by what either
/// costs (`WeightedTrack::judgements`):
/// - down-weighted measurements that a larger process noise explains are right: a strike;
/// - measurements that only a jump of the process noise follows, and that a common error of
///   position explains, are wrong: a tracker that is on another body for some frames.
/// `noise` and the tracks' curves and weights are their estimates without these decisions.
void judge_points(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                  const SmoothOptions& options);

}  // namespace touchtrace
