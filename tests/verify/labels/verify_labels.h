#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// Rows of `touchtrace-verify labels`: smoothing and clocks on synthetic tracks, and labels of
/// simulated half-minute scenes against their truth. Scenes: ten of activity and object and two of
/// objects held at one end, three seeds each; an occlusion; an object of the glove's colour; every
/// tracker at two image sizes.
Verification verify_labels();

}  // namespace touchtrace::study
