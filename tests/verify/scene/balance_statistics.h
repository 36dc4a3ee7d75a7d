#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// What balancing is like, over all clips.
struct BalanceStatistics {
  double lost_share = 0.0;
  double lean_rms_rad = 0.0, lean_most_rad = 0.0;  ///< of the object's axis from upright
  double hand_rms_m = 0.0, hand_most_m = 0.0;      ///< from the clip's mean, in the plane
  double slow_share = 0.0;       ///< of the power of the hand's velocity, between 0.25 and 2.5 Hz
  double moment_rms_nm = 0.0;    ///< of the hand on the foot, about its middle, across the axis
  double moment_residual = 0.0;  ///< of that, against what the object's motion needs; over its rms
  double pressure_m_per_rad = 0.0;  ///< how far the centre of pressure goes with the lean
  double pressure_r2 = 0.0;         ///< of the lean from the centre of pressure
};

/// `options` of the activity balance.
BalanceStatistics balance_statistics(const SceneOptions& options, int clips);

}  // namespace touchtrace::scene
