#pragma once

#include <vector>

#include "calib/smooth/smooth.h"
#include "pipeline/label/calibration_error.h"
#include "pipeline/label/clip_tracker.h"
#include "pipeline/label/timeline.h"
#include "pipeline/recording/labels.h"

namespace touchtrace::label {

/// Smoothed tracks of hand and object, one per clip.
struct SmoothedBodies {
  SmoothedTracks hand, object;
};

/// Initial flights: none, guess_flights or guess_bounces (the object flies except at hits).
enum class FlightSearch { none, throws, bounces };

/// Smooths both bodies. `num_threads` 0: one per core.
SmoothedBodies smooth_bodies(const std::vector<ClipTrack>& tracks,
                             const Eigen::Vector3d& gravity_m_per_s2, FlightSearch search,
                             int num_threads = 1);

/// Appends states, covariances and quality flags of both bodies at every glove frame to `labels`.
/// Covariance: the smoother's, plus systematic errors that neighbouring measurements share, plus
/// the calibration's.
void resample(const std::vector<LabelTime>& times, const std::vector<ClipTrack>& tracks,
              const SmoothedBodies& bodies, const CalibrationError& calibration, Labels& labels);

/// Measured positions of all clips, before smoothing.
RawTrack raw_track(const std::vector<ClipTrack>& tracks);

}  // namespace touchtrace::label
