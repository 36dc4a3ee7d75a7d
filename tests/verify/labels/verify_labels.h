#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// Rows of `touchtrace-verify labels`: smoothing and clocks on synthetic tracks; then half-minute
/// scenes, simulated, calibrated, labelled and held against the truth: ten of activity and object
/// over three seeds of its own, two more of objects held at one end, an occlusion, an object like
/// the glove, and every tracker at two image sizes.
Verification verify_labels();

}  // namespace touchtrace::study
