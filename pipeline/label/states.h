#pragma once

#include <vector>

#include "calib/smooth/smooth.h"
#include "pipeline/label/calibration_error.h"
#include "pipeline/label/follow.h"
#include "pipeline/label/timeline.h"
#include "pipeline/recording/labels.h"

namespace touchtrace::label {

/// The clips' tracks of hand and object, smoothed.
struct SmoothedBodies {
  SmoothedTracks hand, object;
};

/// Smooths both bodies, on `threads` (0: one a core). Flights are guessed where the object leaves
/// the hand; nothing flies, nothing is searched. With `bounces` the object flies always, but for
/// the moments of hits.
SmoothedBodies smooth_bodies(const std::vector<ClipTrack>& tracks,
                             const Eigen::Vector3d& gravity_m_per_s2, bool bounces,
                             int threads = 1);

/// Both bodies' states at every glove frame, with what the calibration may be off in their
/// covariance, and their quality.
void resample(const std::vector<GloveFrame>& frames, const std::vector<ClipTrack>& tracks,
              const SmoothedBodies& bodies, double camera_period_s,
              const CalibrationError& calibration, Labels& labels);

/// What was measured, clip after clip.
RawTrack raw_track(const std::vector<ClipTrack>& tracks);

}  // namespace touchtrace::label
