#pragma once

#include <vector>

#include "calib/smooth/smooth.h"
#include "pipeline/label/states/error_budget.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/label/track/clip_tracker.h"
#include "pipeline/recording/labels.h"

namespace touchtrace::label {

/// Smoothed tracks of hand and object, one per clip.
struct SmoothedBodies {
  SmoothedTracks hand, object;
};

/// Whether the object may fly. Flights are found by find_flights().
enum class Flights { none, find };

/// Smooths both bodies. `num_threads` 0: one per core.
SmoothedBodies smooth_bodies(const std::vector<ClipTrack>& tracks,
                             const Eigen::Vector3d& gravity_m_per_s2, Flights search,
                             int num_threads = 1);

/// Multiplies a body's standard deviations by the scale of its errors that smoothing found, if they
/// are too small for its motion in a clip and then at most 30 mm. Small or distant objects show too
/// little for a stable fit. Returns whether any changed; then smooth again.
bool raise_sigmas(std::vector<ClipTrack>& tracks, const SmoothedBodies& bodies);

/// Appends states, covariances, error budgets and quality flags of both bodies at every label time
/// to `labels`.
void resample(const std::vector<LabelTime>& times, const std::vector<ClipTrack>& tracks,
              const SmoothedBodies& bodies, const ErrorModel& errors, Labels& labels);

/// Measured positions of all clips, before smoothing, with standard deviations of all sources.
RawTrack raw_track(const std::vector<ClipTrack>& tracks, const SmoothedBodies& bodies,
                   const ErrorModel& errors);

}  // namespace touchtrace::label
