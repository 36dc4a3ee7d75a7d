#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// What a set of clips is like, to be held against life and against the traps of simulated grasps.
struct ClipStatistics {
  double drop_share = 0.0;
  double grip_p01_n = 0.0, grip_p99_n = 0.0;  ///< normal forces of all taxels, while in contact
  double lowest_object_m = 0.0;               ///< against the hand; free falls end the clip
  double saturated_share = 0.0;               ///< of all readings, at the converter's end
  double clamped_clip_share = 0.0;            ///< clips with a contact beyond its law
  double force_residual = 0.0;                ///< rms of F - m (a - g) against rms of F
  std::vector<double> apex_m;                 ///< of every flight, above its release
  std::vector<double> turn_in_hand_rad;       ///< of every clip that held: the most since its start
};
/// NaN of no values.
double percentile(std::vector<double> values, double share);

ClipStatistics statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object);

}  // namespace touchtrace::scene
