#pragma once

#include "pipeline/label/states/states.h"
#include "pipeline/label/track/clip_tracker.h"

namespace touchtrace::label {

inline constexpr double min_found_fraction = 0.5;  ///< of a clip's frames; less: mostly lost

/// Sets the problem of clips in which hand and object were mostly lost, and drops their tracks.
/// Where one of them was, drops its observations and warns: what was found may be another body.
/// Warns of an object that was mostly hidden.
void drop_lost_clips(std::vector<ClipFrames>& clips, std::vector<ClipTrack>& tracks);

/// Drops the object's observations in clips in whose box frame is_outside_box(), and warns.
void drop_objects_outside_boxes(const Camera& color, const std::vector<ClipFrames>& clips,
                                std::vector<ClipTrack>& tracks);

/// Sets the problem of clips of which a body has measurements but no smoothed motion, hence no
/// label, and drops their tracks and motions.
void drop_unsmoothed_clips(std::vector<ClipFrames>& clips, std::vector<ClipTrack>& tracks,
                           SmoothedBodies& bodies);

/// Throws the first clip's problem if no clip is usable.
void require_usable_clip(const std::vector<ClipFrames>& clips);

}  // namespace touchtrace::label
