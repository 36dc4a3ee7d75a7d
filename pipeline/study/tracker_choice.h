#pragma once

#include <string>

#include "pipeline/label/learn/scene_model.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// Proposed `label --tracker` with the reason.
struct TrackerChoice {
  std::string tracker, why;
};

/// Proposal without a recording: csrt-fast.
TrackerChoice default_tracker();

/// Proposes "component", which uses colour and depth alone, if at least 3 % of every object's box
/// in the clips' first frames has colours that the hand does not have; else "csrt-fast", which also
/// uses shape. Reads up to 8 images per object of a recording that can be labelled; needs no
/// calibration.
TrackerChoice choose_tracker(const Recording& recording, const label::FrameSource& frames);

}  // namespace touchtrace::study
