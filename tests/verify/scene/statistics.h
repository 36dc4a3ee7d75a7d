#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Statistics of a set of clips, to compare with people and to detect faults of simulated grasps.
struct ClipStatistics {
  double drop_share = 0.0;                    ///< fraction of clips in which the object fell
  double grip_p01_n = 0.0, grip_p99_n = 0.0;  ///< percentiles of the grip force while in contact
  double lowest_object_m = 0.0;               ///< smallest height of the object above the hand
  double saturated_share = 0.0;               ///< fraction of readings at the converter's maximum
  double clamped_clip_share = 0.0;            ///< fraction of clips with too deep contacts
  double force_residual = 0.0;                ///< rms of F - m (a - g) over rms of F
  std::vector<double> apex_m;                 ///< of every flight, above its release
  std::vector<double> turn_in_hand_rad;       ///< largest rotation in the hand, of each held clip
};

ClipStatistics statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object);

}  // namespace touchtrace::scene
