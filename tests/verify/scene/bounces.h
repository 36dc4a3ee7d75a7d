#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// How a ball is bounced in a set of clips.
struct BounceStatistics {
  double rate_hz = 0.0;         ///< impacts a second
  std::vector<double> apex_m;   ///< of the ball between two impacts, above the first
  double braking_share = 0.0;   ///< of the impacts that the face meets while it is slowing down
  std::vector<double> aside_m;  ///< of the impacts from the middle of the face
};
BounceStatistics bounce_statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object);

}  // namespace touchtrace::scene
