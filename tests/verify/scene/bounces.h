#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Statistics of the bounces of a ball over all clips.
struct BounceStatistics {
  double rate_hz = 0.0;         ///< impacts per second
  std::vector<double> apex_m;   ///< height of the ball between two impacts, above the first
  double braking_share = 0.0;   ///< fraction of impacts at which the face decelerates
  std::vector<double> aside_m;  ///< distance of the impacts from the face's centre
};
BounceStatistics bounce_statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object);

}  // namespace touchtrace::scene
