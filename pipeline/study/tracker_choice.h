#pragma once

#include <string>

#include "pipeline/label/scene_model.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::study {

/// A tracker for `label`, and why it is proposed.
struct TrackerChoice {
  std::string tracker, why;
};

/// What suits a recording that is not there yet.
TrackerChoice usual_tracker();

/// "component" where colours tell hand and object apart in the clips' first frames, by their boxes,
/// else "csrt-fast", which follows shapes, too. Needs no calibration; reads a few images of a
/// recording that can be labelled.
TrackerChoice choose_tracker(const Recording& recording, const label::FrameSource& frames);

}  // namespace touchtrace::study
