#pragma once

#include "engine/base/figure.h"

namespace touchtrace::study {

/// Rows of `touchtrace verify labels`: smoothing and clocks on synthetic tracks, then simulate,
/// calibrate and label against the truth, with both trackers, on half a minute of wave and throw.
Verification verify_labels();

}  // namespace touchtrace::study
