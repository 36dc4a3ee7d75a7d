#pragma once

#include "pipeline/recording/labels.h"

namespace touchtrace::study {

/// Labels at the times of the glove's frames, without states: all zero and flagged as lost. Throws
/// data_error without glove frames or clips.
Labels unlabelled(const Recording& recording);

}  // namespace touchtrace::study
