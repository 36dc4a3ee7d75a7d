#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smoothed_track.h"
#include "pipeline/label/states/timeline.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

/// Estimates the camera's latency, between 0 and 0.35 s, from the delay at which touch follows the
/// hand's acceleration: inertia loads the hand. In segments of up to 20 s, averages over 4 x 4
/// parts of the glove are linear functions of the acceleration and of the specific force's size;
/// the latency maximises their likelihood. Its standard deviation contains the scatter of the
/// segments (jackknife) and the unknown lag of the sensor. `times`: label times on the clock of
/// `timeline`. `tracks`, `hand_tracks` [clips]: measured and smoothed. nullopt for fewer than three
/// segments, or if the uncertainty is over 3/4 of the timeline's: a hand that hardly moves or holds
/// nothing.
std::optional<LatencyEstimate> latency_from_touch(const GloveStream& glove,
                                                  const Timeline& timeline,
                                                  const std::vector<LabelTime>& times,
                                                  const std::vector<ClipTrack>& tracks,
                                                  const std::vector<SmoothedTrack>& hand_tracks,
                                                  const Eigen::Vector3d& gravity_m_per_s2);

}  // namespace touchtrace::label
