#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Statistics of the activity balance over all clips.
struct BalanceStatistics {
  double lost_share = 0.0;                        ///< fraction of clips in which the object fell
  double lean_rms_rad = 0.0, lean_max_rad = 0.0;  ///< of the object's axis from the hand's normal
  double hand_rms_m = 0.0, hand_max_m = 0.0;      ///< horizontal distance from the clip's mean
  double slow_share = 0.0;     ///< fraction of the hand velocity's power in 0.25 to 2.5 Hz
  double moment_rms_nm = 0.0;  ///< moment of the hand about the foot's centre, across the axis
  double moment_residual =
      0.0;  ///< rms of that minus the moment that the motion needs, over its rms
  double pressure_m_per_rad = 0.0;  ///< regression of the centre of pressure on the lean
  double pressure_r2 = 0.0;         ///< squared correlation of lean and centre of pressure
};

/// Simulates clips with `options`, whose activity is balance.
BalanceStatistics balance_statistics(const SceneOptions& options, int clips);

}  // namespace touchtrace::scene
