#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// `touchtrace-verify calibration`: the photographs of Debian's opencv-doc, then simulated boards.
Verification calibration_verification();

}  // namespace touchtrace
