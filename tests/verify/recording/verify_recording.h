#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Measures CPU time and size per frame, and the effect of bit flips and of killed writers on a
/// recording. Works in a temporary folder.
Verification verify_recording();

}  // namespace touchtrace
